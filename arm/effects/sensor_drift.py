"""An accelerometer's zero that wanders as the run goes on."""

import numpy as np

from arm.effects.effect import EffectKind, Parameter, Values, vector
from arm.model import Floats

_AXES = ("x_m_s3", "y_m_s3", "z_m_s3")


def _reading(a: Floats, t: Floats, _axes: Floats, values: Values) -> Floats:
    wandered: Floats = a + np.outer(t, vector(values, *_AXES))
    return wandered


EFFECT = EffectKind(
    name="sensor_drift",
    sentence="the accelerometer's zero wanders as the run goes on",
    place="sensor",
    parameters=tuple(Parameter(name, "m/s^3", -1.0, 1.0, linear=True, neutral=0.0) for name in _AXES),
    taken_for=("sensor_bias",),
    reading=_reading,
)
