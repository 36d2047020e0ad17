"""Torque that comes late: the joint gets what was asked for some time ago."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_numbers import DELAY

EFFECT = EffectKind(
    name="actuator_delay",
    sentence="the torque comes late",
    place="drive",
    parameters=(Parameter("delay_s", "s", 0.0, 1.0, neutral=0.0),),
    taken_for=("actuator_lag", "joint_elasticity", "time_skew", "viscous"),
    simulated={DELAY: "delay_s"},
)
