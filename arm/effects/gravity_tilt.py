"""A plane of motion that is not level: gravity has a part in the base frame's x and y."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, number
from arm.model import Arm, Effect


def _change(arm: Arm, effect: Effect) -> Arm:
    x, y, z = arm.gravity_m_s2
    gx, gy = (number(effect.parameters, name) for name in ("gx_m_s2", "gy_m_s2"))
    return replace(arm, gravity_m_s2=(x + gx, y + gy, z))


EFFECT = EffectKind(
    name="gravity_tilt",
    sentence="the arm's plane is not level, so gravity pulls along it",
    place="arm",
    parameters=(
        Parameter("gx_m_s2", "m/s^2", -20.0, 20.0, linear=True, neutral=0.0),
        Parameter("gy_m_s2", "m/s^2", -20.0, 20.0, linear=True, neutral=0.0),
    ),
    taken_for=("cogging", "joint_spring", "joint_zero", "sensor_misalignment", "torque_offset"),
    whole=True,
    change=_change,
)
