"""`fitter dynamics --payload`."""

import argparse
from dataclasses import replace

import pytest

from arm.arm_file import save_arm
from arm.model import Control
from fitter.commands.payload_option import known_load
from fitter.data.motion_file import write_motion
from tests.fitter.dynamics.test_known_load import ARM, LOAD, run


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    """Write four motions whose torque is measured, two of them with a load, and their arm."""
    folder = tmp_path_factory.mktemp("loads")
    save_arm(replace(ARM, control=Control("measured")), folder / "arm.toml")
    for k, trial in enumerate(run((1.2, 1.0)), 1):
        columns = {name: getattr(trial, name) for name in ("t", "q", "dq", "ddq", "tau")}
        write_motion(folder / f"{k}.csv", columns)
    return folder


def test_a_load_is_taken_off_and_gauges_the_torque(fitter, loaded):
    data = [loaded / f"{k}.csv" for k in (1, 2, 3, 4)]
    common = ("--arm", loaded / "arm.toml", "--method", "least-squares", "--out", loaded / "out.toml")
    with_it = fitter("dynamics", *data[:3], "--evaluate", data[3], *common, "--payload", "0.8:2,4")
    assert with_it.code == 0
    load = with_it.document["payload"]
    assert load["mass_kg"] == LOAD.mass_kg and load["trials"] == [2, 4]
    first, second = load["torque_factor"]
    assert first["ci95"][0] < 1.2 < first["ci95"][1] and second["ci95"][0] < 1.0 < second["ci95"][1]
    (note,) = [note for note in with_it.document["notes"] if note["kind"] == "torque_factor"]
    assert "joint 1 was measured too large by a factor of 1." in note["text"]
    without = fitter("dynamics", *data[:3], "--evaluate", data[3], *common)
    left = [outcome.document["torque_rms_N_m"]["evaluate"][1] for outcome in (with_it, without)]
    assert left[0] < 0.5 * left[1]


def test_a_law_has_no_torque_that_a_load_is_taken_off(fitter, loaded):
    common = ("--out", loaded / "out.toml", "--payload", "0.8:2")
    outcome = fitter("dynamics", loaded / "1.csv", "--arm", "dd-arm", *common)
    assert outcome.code == 2 and "--payload needs measured torque" in outcome.said


@pytest.mark.parametrize("text", ["", "0.5", "0.5:", "-1:2", "0.5:0", "0.5:3-1", "x:1", "nan:1", "0.5:1,,2"])
def test_what_is_no_load_is_refused(text):
    with pytest.raises(argparse.ArgumentTypeError, match="is no load"):
        known_load(text)


def test_ranges_of_trials_are_read():
    assert known_load("0.5:2,4-6").trials == {2, 4, 5, 6}
