"""A stiff limit on one side: ``side`` is +1 where it stops the joint forwards, -1 backwards."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import Numbers, Q, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[1] * p[2] * max(p[2] * (x[Q] - p[0]), 0.0)


EFFECT = EffectKind(
    name="end_stop",
    sentence="the joint runs against a stiff limit",
    place="joint",
    parameters=(
        Parameter("angle_rad", "rad", -10.0, 10.0),
        Parameter("stiffness_N_m_rad", "N m/rad", 0.0, 1e6, linear=True, neutral=0.0),
        Parameter("side", "1", -1.0, 1.0),
    ),
    taken_for=("joint_spring", "passive_tissue"),
    torque=_torque,
)
