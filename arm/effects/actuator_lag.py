"""Torque that follows slowly: ``T x' = u - x``, and the joint gets x."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_numbers import LAG

EFFECT = EffectKind(
    name="actuator_lag",
    sentence="the torque follows slowly what is asked for",
    place="drive",
    # Electric drives follow within milliseconds, pneumatic ones within tenths of a second, no drive more slowly.
    parameters=(Parameter("time_constant_s", "s", 0.0, 0.5, neutral=0.0),),
    taken_for=("actuator_delay", "joint_elasticity", "viscous"),
    simulated={LAG: "time_constant_s"},
)
