"""Resistance that grows with the square of the speed: air, fluid, a fan of one's own links."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DQ, Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * x[DQ] * abs(x[DQ])


EFFECT = EffectKind(
    name="quadratic_drag",
    sentence="resistance grows with the speed squared",
    place="joint",
    parameters=(Parameter("drag_N_m_s2", "N m s^2/rad^2", 0.0, 1e3, linear=True, neutral=0.0),),
    taken_for=("air_drag", "coulomb", "viscous"),
    torque=_torque,
)
