"""Torque that follows slowly: ``T x' = u - x``, and the joint gets x."""

from arm.effects.effect import EffectKind, Parameter

EFFECT = EffectKind(
    name="actuator_lag",
    sentence="the torque follows slowly what is asked for",
    place="drive",
    parameters=(Parameter("time_constant_s", "s", 0.0, 10.0, neutral=0.0),),
    taken_for=("actuator_delay", "joint_elasticity", "viscous"),
)
