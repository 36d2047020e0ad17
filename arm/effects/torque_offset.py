"""A constant torque: an amplifier's zero, a weight on a string."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return -p[0]


EFFECT = EffectKind(
    name="torque_offset",
    sentence="a constant torque acts on the joint",
    place="joint",
    parameters=(Parameter("torque_N_m", "N m", -1e3, 1e3, linear=True, neutral=0.0),),
    taken_for=("coulomb_asymmetry", "gravity_tilt", "joint_spring"),
    holds=True,
    torque=_torque,
)
