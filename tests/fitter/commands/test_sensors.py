"""`fitter sensors`."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.data.motion_file import write_motion


@pytest.fixture(scope="module")
def raw(short_run, tmp_path_factory):
    path = tmp_path_factory.mktemp("raw") / "day.npz"
    columns = short_run.raw_columns()
    write_motion(path, {name: values[:20000] for name, values in columns.items() if name not in ("q", "ref")})
    return path


def test_sensors_are_calibrated_and_written(fitter, raw, tmp_path):
    out = tmp_path / "new" / "found.toml"
    outcome = fitter("sensors", raw, "--arm", "dd-arm", "--initial-q", "0,0", "--out", out)
    assert outcome.code == 0
    document = outcome.document
    assert set(document) == {
        "axes", "sensors", "not_revealed", "passes", "converged", "doubted", "samples", "seconds", "out",
        "lengths", "notes",
    }  # fmt: skip
    assert (document["out"], document["samples"], document["converged"]) == (str(out), 20000, True)
    assert list(document["sensors"]) == ["s1", "s2", "s3", "s4"]
    assert {number["unit"] for number in document["sensors"]["s1"].values()} == {"m/s^2", "1", "rad", "m"}
    assert "not identifiable" in outcome.said
    assert all(sentence in outcome.said for sentence in document["not_revealed"])
    found = load_arm(out)
    for sensor in found.sensors:
        numbers = document["sensors"][sensor.name]
        assert sensor.scale == pytest.approx([numbers[f"scale_{axis}"]["value"] for axis in "xyz"])
        assert sensor.bias_m_s2 == pytest.approx([numbers[f"bias_{axis}"]["value"] for axis in "xyz"])
    length = document["lengths"]["a1"]
    assert (found.joints[0].a_m, found.joints[0].length_std_m) == (length["value"], length["std"])
    assert abs(length["value"] - 0.25) < 4.0 * length["std"] < 0.02
    assert found.joints[1].a_m == 0.3


def test_how_far_off_the_sensors_may_be_is_believed(fitter, raw, tmp_path):
    stds = []
    for k, place in enumerate(("0.001", "5")):
        options = ("--scale-std", "0.005", "--turn-std-deg", "0.5", "--place-std-mm", place)
        outcome = fitter("sensors", raw, "--arm", "dd-arm", *options, "--out", tmp_path / f"{k}.toml")
        numbers = outcome.document["sensors"]["s2"]
        assert numbers["scale_z"]["std"] <= 0.005 and numbers["turn_z"]["std"] <= np.deg2rad(0.5)
        stds.append(numbers["place_z"]["std"])
    assert stds == pytest.approx([1e-6, 5e-3], rel=1e-3)
