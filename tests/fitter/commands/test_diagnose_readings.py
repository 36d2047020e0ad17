"""The document of a diagnosis of readings."""

from types import SimpleNamespace

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.commands.diagnose_readings import document
from fitter.diagnosis.finding import UNKNOWN, UNKNOWN_ERRORS
from fitter.reading_diagnosis.rigidity import _rms
from fitter.reading_diagnosis.sensor_residual import SensorResidual
from fitter.reading_diagnosis.sensor_verdict import Course, SensorFinding

NOTHING = np.zeros(0)
FOUND = SensorFinding(
    "named", (), (), (), "", {"s1": 0.4}, {"s1": 0.2}, 0.75, 9.0, 3.0, 1.02,
    SensorResidual(0.0, True, ()), load_arm("dd-arm"), Course(NOTHING, NOTHING, NOTHING, NOTHING),
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
    arm = load_arm("dd-arm")
    shape = (100, 3 * len(arm.sensors))
    residual, weight = np.full(shape, 0.02), np.full(shape, 50.0)
    residual[7], weight[7] = 3.0, 0.1
    rms = _rms(arm, [SimpleNamespace(residual=residual, weight=weight)])
    assert list(rms.values()) == pytest.approx([0.02 * np.sqrt(3.0)] * len(arm.sensors), rel=0.01)
