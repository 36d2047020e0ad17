"""Somebody or something pushed, once; several pushes are several effects."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_torque import Numbers, T, joint_torque


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return -p[2] if p[0] <= x[T] <= p[0] + p[1] else 0.0


EFFECT = EffectKind(
    name="external_push",
    sentence="somebody or something pushed the joint",
    place="joint",
    parameters=(
        Parameter("start_s", "s", 0.0, 1e6),
        Parameter("duration_s", "s", 1e-3, 1e4),
        Parameter("torque_N_m", "N m", -1e3, 1e3, linear=True, neutral=0.0),
    ),
    taken_for=("payload",),
    event=True,
    torque=_torque,
)
