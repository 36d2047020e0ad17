"""What the diagnosis says of sensors in which one thing is wrong, and of those in which nothing is."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.commands.diagnose_readings import document
from fitter.diagnosis.finding import UNKNOWN, UNKNOWN_ERRORS
from fitter.reading_diagnosis.rigidity import diagnose_sensors
from limbcal.errors import ConfigError, DataError


def drift(a, t):
    a[:, 3:6] += np.outer(t, [0.02, -0.01, 0.015])
    return a


def clipping(a, _t):
    a[:, 9:12] = np.clip(a[:, 9:12], -4.0, 4.0)
    return a


def late(a, t):
    a[:, 6:9] = np.column_stack([np.interp(t - 0.012, t, column) for column in a[:, 6:9].T])
    return a


WRONG = {
    "sensor_bias": ("s2", {1: {"bias_m_s2": (0.3, -0.2, 0.25)}}, None, {"x_m_s2": 0.3, "y_m_s2": -0.2}),
    "sensor_drift": ("s2", {}, drift, {"x_m_s3": 0.02, "y_m_s3": -0.01, "z_m_s3": 0.015}),
    "sensor_scale": ("s4", {3: {"scale": (1.06, 0.93, 1.0)}}, None, {"x": 1.06, "y": 0.93}),
    "sensor_misalignment": ("s1", {0: {"rotation_rad": (0.05, 0.03, -0.06)}}, None, {"yaw_rad": -0.06}),
    "mounting_radius": ("s3", {2: {"position_m": (0.11, -0.03, 0.0)}}, None, {"x_m": 0.03, "y_m": -0.03}),
    "sensor_highpass": ("s4", {3: {"highpass_hz": 0.3}}, None, {"corner_hz": 0.3}),
    "sensor_clipping": ("s4", {}, clipping, {"level_m_s2": 4.0}),
    "time_skew": ("s3", {}, late, {"delay_s": 0.012}),
}


@pytest.mark.parametrize("effect", WRONG)
def test_names_what_is_wrong_and_with_which_sensor(measure, effect):
    sensor, changed, touch, truth = WRONG[effect]
    run = measure(changed=changed, touch=touch, each=1)
    found = diagnose_sensors(run.arm, run.learn, run.evaluate)
    assert found.verdict == "named"
    (cause,) = found.causes
    assert (cause.effect, cause.sensors) == (effect, (sensor,))
    for name, value in truth.items():
        number = cause.parameters[name]
        assert abs(number.value - value) < 4.0 * number.std
    assert found.after[sensor] < found.before[sensor]
    said = document(found)
    assert 0.0 < said["left"]["share"] < 1.0
    assert said["gain"]["readings"] == pytest.approx(1.0 - said["left"]["share"] ** 2)
    assert 0.5 < said["left"]["times_noise"] < 1.5 and said["complete"] is True
    assert set(UNKNOWN) <= set(said) and set(UNKNOWN_ERRORS) <= set(said["after"])
    assert said["left"]["reading_rms_m_s2"] == found.after
    assert found.arm.effects[-1].sensors == (sensor,)


@pytest.mark.parametrize("name", ["dd-arm", "dd-arm-vertical"])
def test_names_nothing_where_nothing_is_wrong(measure, name):
    run = measure(name, seed=32)
    found = diagnose_sensors(run.arm, run.learn, run.evaluate)
    assert (found.verdict, found.causes) == ("none", ())
    assert found.residual.white
    assert found.arm is run.arm
    assert document(found)["complete"] is True


def test_a_bias_along_gravity_on_a_lying_arm_may_be_a_scale(measure):
    run = measure("dd-arm", changed={2: {"bias_m_s2": (0.0, 0.0, 0.5)}}, each=1)
    found = diagnose_sensors(run.arm, run.learn, run.evaluate)
    assert found.verdict == "ambiguous"
    assert ("sensor_bias", "sensor_scale") in found.confusable
    assert {cause.sensors for cause in found.causes} == {("s3",)}
    assert "gravity" in found.next_experiment


def test_true_angles_are_not_looked_at(measure):
    run = measure("dd-arm", seed=32)
    lying = [replace(one, q=np.full((len(one.t), 2), np.nan)) for one in run.learn]
    assert diagnose_sensors(run.arm, lying, run.evaluate).verdict == "none"


def test_says_what_is_missing(measure):
    run = measure("dd-arm")
    with pytest.raises(DataError, match="2 trials to learn from, 0 to judge by"):
        diagnose_sensors(run.arm, run.learn, [])
    with pytest.raises(ConfigError, match="no \\[\\[sensor\\]\\]"):
        diagnose_sensors(replace(load_arm("dd-arm"), sensors=()), run.learn, run.evaluate)
    narrow = [replace(one, a=one.a[:, :9]) for one in run.learn]
    with pytest.raises(DataError, match="9 channels, expected 12"):
        diagnose_sensors(run.arm, narrow, run.evaluate)
