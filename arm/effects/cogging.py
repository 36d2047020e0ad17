"""A torque that ripples with the angle: magnets, teeth, an eccentric gear."""

import math

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import Numbers, Q, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return -p[0] * math.sin(p[2] * x[Q] + p[1])


EFFECT = EffectKind(
    name="cogging",
    sentence="the torque ripples with the joint's angle",
    place="joint",
    parameters=(
        Parameter("amplitude_N_m", "N m", 0.0, 1e3, linear=True, neutral=0.0),
        Parameter("phase_rad", "rad", -6.3, 6.3),
        Parameter("periods_per_turn", "1", 0.1, 1e3),
    ),
    taken_for=("gravity_tilt", "periodic_disturbance"),
    torque=_torque,
)
