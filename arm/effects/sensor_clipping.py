"""A sensor whose range is too small for what it feels."""

import math

import numpy as np

from arm.effects.effect import EffectKind, Parameter, Values, number
from arm.model import Floats


def _converted(a: Floats, _t: Floats, _axes: Floats, values: Values) -> Floats:
    level = number(values, "level_m_s2")
    return np.asarray(np.clip(a, -level, level), dtype=np.float64)


EFFECT = EffectKind(
    name="sensor_clipping",
    sentence="the accelerometer's range is too small for the motion",
    place="sensor",
    parameters=(Parameter("level_m_s2", "m/s^2", 1e-3, 1e6, neutral=math.inf),),
    taken_for=("sensor_scale",),
    converted=_converted,
)
