"""The fitter's own messages."""

import numpy as np
import pytest

from fitter.live.calibration import Calibration
from fitter.live.progress_message import dynamics_fields, kinematics_fields
from protocol.message import DYNAMICS, KINEMATICS, decode, encode


def test_geometry(calibration):
    fields = kinematics_fields(calibration)
    assert set(fields) == {"generation", "frames", "parameters", "error"}
    assert fields["frames"] == sum(len(trial.t) for trial in calibration.learn)
    assert fields["generation"] == calibration.geometry.generations > 0
    assert fields["error"] == pytest.approx(calibration.geometry.tip_rms_m)
    assert set(fields["parameters"]["a1"]) == {"value", "std"}
    assert fields["parameters"]["d1"] == {"value": 0.0, "std": None}  # never identified, so without an error


def test_dynamics(calibration):
    fields = dynamics_fields(calibration)
    assert set(fields) == {"generation", "samples", "parameters", "error"}
    assert fields["samples"] == calibration.dynamics.samples
    assert fields["generation"] == calibration.dynamics.generations > 0
    value = fields["parameters"]["I2"]
    assert value["value"] == pytest.approx(0.471209, rel=0.01) and 0.0 < value["std"] < 0.01
    assert fields["parameters"]["F1"]["std"] is None
    assert 0.0 < fields["error"] < 1.0


@pytest.mark.parametrize(("topic", "fields_of"), [(KINEMATICS, kinematics_fields), (DYNAMICS, dynamics_fields)])
def test_they_travel_whole(calibration, short_run, topic, fields_of):
    for state in (calibration, Calibration(short_run.arm)):
        fields = fields_of(state)
        back, received = decode(encode(topic, fields))
        assert back == topic
        assert {name: value for name, value in received.items() if name != "v"} == fields


def test_before_anything_is_known(short_run):
    calibration = Calibration(short_run.arm)
    assert dynamics_fields(calibration) == {"generation": 0, "samples": 0, "parameters": {}, "error": None}
    fields = kinematics_fields(calibration)
    assert fields == {"generation": 0, "frames": 0, "parameters": {}, "error": None}
    calibration.geometry.add(np.zeros((60, 2)), np.zeros((60, 3)), np.zeros(2))  # sixty frames of rest
    assert kinematics_fields(calibration) == fields | {"frames": 60}
