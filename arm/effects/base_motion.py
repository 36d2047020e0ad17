"""A base that moves: all sensors feel its acceleration, a sine along each of the base frame's axes."""

import math

import numpy as np

from arm.effects.effect import EffectKind, Parameter, Values, number, vector
from arm.model import Floats

_AXES = ("x_m_s2", "y_m_s2", "z_m_s2")


def _force(a: Floats, t: Floats, axes: Floats, values: Values) -> Floats:
    wave = math.sqrt(2.0) * np.sin(2.0 * math.pi * number(values, "frequency_hz") * t)
    felt = wave[:, None] * np.array(vector(values, *_AXES))
    return a + np.asarray(np.einsum("kji,kj->ki", axes, felt), dtype=np.float64)


EFFECT = EffectKind(
    name="base_motion",
    sentence="the arm's base itself moves",
    place="sensor",
    parameters=(
        *(Parameter(name, "m/s^2", -100.0, 100.0, linear=True, neutral=0.0) for name in _AXES),
        Parameter("frequency_hz", "Hz", 1e-2, 1e4),
    ),
    taken_for=("periodic_disturbance",),
    whole=True,
    force=_force,
)
