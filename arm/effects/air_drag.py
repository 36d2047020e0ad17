"""Air, or a fluid, that resists a link's turning in space: by the square of the link's own angular velocity.

A moment ``-c |omega| omega`` acts on the link from outside, so it asks for torque at every joint before it. At the
first joint that is `quadratic_drag`; further out it is not, for a link can be still while its joint turns.
"""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter, number, with_joints
from arm.model import Arm, Effect, Joint


def _change(arm: Arm, effect: Effect) -> Arm:
    more = number(effect.parameters, "drag_N_m_s2")

    def dragged(joint: Joint) -> Joint:
        link = joint.link
        return replace(joint, link=replace(link, air_drag_N_m_s2=(link.air_drag_N_m_s2 or 0.0) + more))

    return with_joints(arm, effect.joints, dragged)


EFFECT = EffectKind(
    name="air_drag",
    sentence="air resists the link's turning in space with its speed squared",
    place="arm",
    parameters=(Parameter("drag_N_m_s2", "N m s^2/rad^2", 0.0, 1e3, linear=True, neutral=0.0),),
    taken_for=("quadratic_drag",),
    change=_change,
)
