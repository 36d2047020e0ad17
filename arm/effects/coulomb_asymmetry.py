"""Friction that differs by direction: more forwards and less backwards."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DIRECTION, Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * abs(x[DIRECTION])


EFFECT = EffectKind(
    name="coulomb_asymmetry",
    sentence="friction is stronger in one direction than in the other",
    place="joint",
    parameters=(Parameter("difference_N_m", "N m", -1e3, 1e3, linear=True, neutral=0.0),),
    taken_for=("torque_offset",),
    holds=True,
    torque=_torque,
)
