"""Somebody or something pushed, once; several pushes are several effects.

With ``trials`` it was in those, by number or by name, on their clock; without, at that time of any trial.
"""

from arm.effects.effect import LATEST_S, EffectKind, Parameter
from arm.effects.joint_torque import Numbers, T, joint_torque
from arm.effects.trials import TRIALS


@joint_torque
def _torque(x: Numbers, p: Numbers) -> float:
    return -p[2] if p[0] <= x[T] <= p[0] + p[1] else 0.0


EFFECT = EffectKind(
    name="external_push",
    sentence="somebody or something pushed the joint",
    place="joint",
    parameters=(
        Parameter("start_s", "s", -LATEST_S, LATEST_S),
        Parameter("duration_s", "s", 1e-3, 1e4),
        Parameter("torque_N_m", "N m", -1e3, 1e3, linear=True, neutral=0.0),
        TRIALS,
    ),
    taken_for=("payload",),
    event=True,
    torque=_torque,
)
