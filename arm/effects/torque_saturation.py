"""A motor that gives no more than so much, in either direction."""

import math

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_numbers import LIMIT

EFFECT = EffectKind(
    name="torque_saturation",
    sentence="the motor gives no more torque than its limit",
    place="drive",
    parameters=(Parameter("limit_N_m", "N m", 0.0, 1e6, neutral=math.inf),),
    taken_for=("gain_error",),
    simulated={LIMIT: "limit_N_m"},
)
