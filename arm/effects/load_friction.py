"""Friction that grows with the load that the joint carries, as in worm and harmonic gears."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DIRECTION, TAU, Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * abs(x[TAU]) * x[DIRECTION]


EFFECT = EffectKind(
    name="load_friction",
    sentence="friction grows with the torque that the joint carries",
    place="joint",
    parameters=(Parameter("coefficient", "1", 0.0, 1.0, linear=True, neutral=0.0),),
    taken_for=("coulomb", "gain_error"),
    holds=True,
    torque=_torque,
)
