"""Friction that depends on the direction alone, beyond what the arm's file has."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import DIRECTION, Numbers, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * x[DIRECTION]


EFFECT = EffectKind(
    name="coulomb",
    sentence="the joint has more dry friction than the model",
    place="joint",
    parameters=(Parameter("coulomb_N_m", "N m", -1e3, 1e3, linear=True, neutral=0.0),),
    taken_for=("load_friction", "quadratic_drag", "stiction", "stribeck", "thermal_drift", "viscous"),
    base="fc",
    torque=_torque,
)
