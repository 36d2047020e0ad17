"""Friction that falls as the joint starts to move (Stribeck 1902)."""

import math

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DIRECTION, DQ, Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * math.exp(-((x[DQ] / p[1]) ** 2)) * x[DIRECTION]


EFFECT = EffectKind(
    name="stribeck",
    sentence="friction is higher at very low speed and falls as the joint starts to move",
    place="joint",
    parameters=(
        Parameter("amplitude_N_m", "N m", 0.0, 1e3, linear=True, neutral=0.0),
        Parameter("velocity_rad_s", "rad/s", 1e-3, 1e2),
    ),
    taken_for=("backlash", "coulomb", "stiction"),
    holds=True,
    torque=_torque,
)
