"""A torque at a fixed frequency: a machine nearby, a fan, the mains."""

import math

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import Numbers, T, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return -p[0] * math.sin(2.0 * math.pi * p[1] * x[T] + p[2])


EFFECT = EffectKind(
    name="periodic_disturbance",
    sentence="a torque at a fixed frequency disturbs the joint",
    place="joint",
    parameters=(
        Parameter("amplitude_N_m", "N m", 0.0, 1e3, linear=True, neutral=0.0),
        Parameter("frequency_hz", "Hz", 1e-2, 1e4),
        Parameter("phase_rad", "rad", -6.3, 6.3),
    ),
    taken_for=("base_motion", "cogging"),
    torque=_torque,
)
