"""Friction that grows with the speed, beyond what the arm's file has."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DQ, Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * x[DQ]


EFFECT = EffectKind(
    name="viscous",
    sentence="the joint has more viscous friction than the model",
    place="joint",
    parameters=(Parameter("viscous_N_m_s", "N m s/rad", -1e3, 1e3, linear=True, neutral=0.0),),
    taken_for=("actuator_delay", "actuator_lag", "coulomb", "joint_elasticity", "quadratic_drag", "thermal_drift"),
    base="D",
    torque=_torque,
)
