"""Friction that changes as the run goes on; before the run begins it is what the arm's file has."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import COULOMB, DIRECTION, DQ, VISCOUS, Numbers, T, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return p[0] * max(x[T], 0.0) * (x[VISCOUS] * x[DQ] + x[COULOMB] * x[DIRECTION])


EFFECT = EffectKind(
    name="thermal_drift",
    sentence="friction changes as the run goes on",
    place="joint",
    parameters=(Parameter("rate_1_s", "1/s", -0.1, 0.1, linear=True, neutral=0.0),),
    taken_for=("coulomb", "viscous"),
    holds=True,
    torque=_torque,
)
