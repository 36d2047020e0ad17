"""A joint that sticks at rest: the paper's F, which must be overcome before it moves."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, number, with_joints
from arm.model import Arm, Effect, Joint


def _change(arm: Arm, effect: Effect) -> Arm:
    def held(joint: Joint) -> Joint:
        return replace(joint, friction=replace(joint.friction, static_N_m=number(effect.parameters, "static_N_m")))

    return with_joints(arm, effect.joints, held)


EFFECT = EffectKind(
    name="stiction",
    sentence="the joint sticks at rest, and holds more there than sliding friction does",
    place="arm",
    parameters=(Parameter("static_N_m", "N m", 0.0, 1e3, neutral=0.0),),
    taken_for=("coulomb", "stribeck"),
    change=_change,
    absolute=True,
)
