"""`fitter diagnose` of accelerations: what it takes for them, and what it writes and says."""

import io
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from arm.arm_file import load_arm
from arm.effects.catalogue import catalogue
from fitter.commands import diagnose_readings as module
from fitter.commands.diagnose_readings import described, diagnose_readings, document, readings
from fitter.data.plausibility.refusal import Refusal
from fitter.diagnosis.finding import UNKNOWN, UNKNOWN_ERRORS
from fitter.reading_diagnosis.rigidity import _rms
from fitter.reading_diagnosis.sensor_residual import SensorResidual
from fitter.reading_diagnosis.sensor_verdict import (
    Course,
    Number,
    SensorCandidate,
    SensorCause,
    SensorFinding,
)
from limbcal.errors import DataError, DeviceError
from tests.fitter.report.test_sensor_diagnosis import finding

CAUSE = SensorCause("sensor_misalignment", ("s1",), {"roll_rad": Number(0.1, 0.01, "rad")}, 0.9)
ARM = load_arm("dd-arm")


def named() -> SensorFinding:
    candidate = SensorCandidate("sensor_misalignment", ("s1", "s2"), 0.75, 0.9)
    return finding(
        causes=(CAUSE,),
        candidates=(candidate,),
        confusable=(("a", "b"),),
        before={"s1": 3.0, "s2": 4.0},
        after={"s1": 0.6, "s2": 0.8},
        arm=replace(ARM, name="put right"),
    )


def test_a_cause_is_said_in_plain_words_with_its_size() -> None:
    sentence = catalogue()["sensor_misalignment"].sentence
    assert described(CAUSE) == f"sensor_misalignment, s1: {sentence} (roll_rad 0.100 ± 0.020 rad)"
    assert described(replace(CAUSE, sensors=())).startswith("sensor_misalignment: ")


def test_the_document_has_what_is_left_as_one_share() -> None:
    one = json.loads(json.dumps(document(named())))
    assert one["left"]["share"] == pytest.approx(0.2)  # of five, one
    assert one["left"]["reading_rms_m_s2"] == {"s1": 0.6, "s2": 0.8}
    assert one["before"]["reading_rms_m_s2"] == {"s1": 3.0, "s2": 4.0} and one["after"]["torque_rms_N_m"] is None
    assert one["verdict"] == "named" and one["complete"] is True
    (cause,), (candidate,) = one["causes"], one["candidates"]
    assert cause["parameters"] == {"roll_rad": {"value": 0.1, "std": 0.01, "unit": "rad"}}
    assert cause["sensors"] == ["s1"] and cause["support"] == 0.9
    assert candidate == {"effect": "sensor_misalignment", "sensors": ["s1", "s2"], "gain": 0.75, "support": 0.9}
    assert one["confusable"] == [["a", "b"]] and one["gain"]["readings"] == 0.9
    assert {"explained": 0.4, "white": True, "depends_on": []}.items() <= one["residual"].items()


def test_where_nothing_was_wrong_nothing_is_left() -> None:
    assert document(finding(before={"s1": 0.0}, after={"s1": 0.0}))["left"]["share"] == 0.0


def test_everything_is_written_and_said(monkeypatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(
        module, "diagnose_sensors", lambda *given: named() if given == (ARM, ["a"], ["b"]) else None
    )
    answer = diagnose_readings(ARM, ["a"], ["b"], tmp_path)
    assert json.loads((tmp_path / "diagnosis.json").read_text()) == json.loads(json.dumps(answer))
    assert answer["notes"] == [] and load_arm(tmp_path / "extended.toml").name == "put right"
    assert described(CAUSE) in (tmp_path / "report.html").read_text()
    said = " ".join(capsys.readouterr().out.split())
    for part in ("The sensors contradict a rigid arm, and this is why:", described(CAUSE), "next: turn it over"):
        assert part in said, part
    with pytest.raises(DeviceError, match="nowhere: cannot be written: No such file"):
        diagnose_readings(ARM, ["a"], ["b"], tmp_path / "nowhere")


def test_a_table_has_each_sensor_before_and_after() -> None:
    text = io.StringIO()
    Console(file=text, width=120).print(
        module._contradictions(finding(before={"s[1]": 0.5}, after={"s[1]": 0.25}))
    )
    assert all(part in text.getvalue() for part in ("s[1]", "[m/s^2]", "0.5", "0.25"))


def test_accelerations_are_known_by_their_columns(tmp_path: Path) -> None:
    t = np.arange(200) / 1000.0
    names = [f"{sensor.name}{axis}" for sensor in ARM.sensors for axis in "xyz"]
    felt = np.tile([0.0, 0.0, 9.81], (200, 4)) + 0.01 * np.random.default_rng(0).normal(size=(200, 12))
    path = tmp_path / "raw.csv"
    np.savetxt(path, np.column_stack([t, felt]), header=",".join(["t", *names]), delimiter=",", comments="")
    (run,) = readings([path], ARM, None, None)
    np.testing.assert_allclose(run.a, felt)
    assert readings([path], replace(ARM, sensors=(), tip=None), None, None) is None
    (tmp_path / "day.mcap").touch()
    assert readings([tmp_path / "day.mcap"], ARM, None, None) is None


@pytest.mark.parametrize(("error", "asks"), [(Refusal("in g?"), True), (DataError("no s1x"), False)])
def test_only_a_question_stops_what_may_be_joint_motion(monkeypatch, tmp_path: Path, error, asks: bool) -> None:
    def load_raw(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(module, "load_raw", load_raw)
    (tmp_path / "m.csv").write_text("")
    if asks:
        with pytest.raises(Refusal):
            readings([tmp_path / "m.csv"], ARM, None, None)
    else:
        assert readings([tmp_path / "m.csv"], ARM, None, None) is None


NOTHING = np.zeros(0)
FOUND = SensorFinding(
    "named", (), (), (), "", {"s1": 0.4}, {"s1": 0.2}, 0.75, 9.0, 3.0, 1.02,
    SensorResidual(0.0, True, ()), ARM, Course(NOTHING, NOTHING, NOTHING, NOTHING),
)  # fmt: skip


def test_it_has_the_keys_of_every_diagnosis():
    said = document(FOUND)
    assert set(UNKNOWN) | {"verdict", "complete", "left", "causes", "candidates", "gain"} <= set(said)
    assert set(UNKNOWN_ERRORS) <= set(said["before"]) and set(UNKNOWN_ERRORS) <= set(said["after"])
    assert set(UNKNOWN["residual"]) == set(said["residual"])


def test_gain_and_share_are_of_the_same_rms():
    said = document(FOUND)
    assert said["gain"]["readings"] == pytest.approx(1.0 - said["left"]["share"] ** 2)
    assert said["left"]["times_noise"] == 1.02 and said["structure"] == {"beyond_noise": 3.0}


def test_a_jolt_that_hardly_counts_is_hardly_in_the_rms():
    arm = ARM
    shape = (100, 3 * len(arm.sensors))
    residual, weight = np.full(shape, 0.02), np.full(shape, 50.0)
    residual[7], weight[7] = 3.0, 0.1
    rms = _rms(arm, [SimpleNamespace(residual=residual, weight=weight)])
    assert list(rms.values()) == pytest.approx([0.02 * np.sqrt(3.0)] * len(arm.sensors), rel=0.01)
