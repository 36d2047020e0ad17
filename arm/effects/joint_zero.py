"""An angle whose zero is off: the link's angle is what is measured plus the offset."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, number, with_joints
from arm.model import Arm, Effect, Joint


def _change(arm: Arm, effect: Effect) -> Arm:
    offset = number(effect.parameters, "offset_rad")

    def moved(joint: Joint) -> Joint:
        if joint.type == "prismatic":  # its variable is added to d
            return replace(joint, d_m=joint.d_m + offset)
        return replace(joint, theta_offset_rad=joint.theta_offset_rad + offset)

    return with_joints(arm, effect.joints, moved)


EFFECT = EffectKind(
    name="joint_zero",
    sentence="the zero of the joint's angle is off",
    place="arm",
    parameters=(Parameter("offset_rad", "rad", -3.2, 3.2, neutral=0.0),),
    taken_for=("gravity_tilt", "joint_spring", "sensor_misalignment"),
    change=_change,
)
