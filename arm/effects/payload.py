"""A mass at the tip, in some trials or from some time on: a point at the far end of the last link."""

from dataclasses import replace

from arm.effects.effect import EffectKind, Parameter
from arm.effects.trials import SINCE, TRIALS
from arm.model import Arm


def with_load(arm: Arm, mass_kg: float) -> Arm:
    """Return the arm with a point mass at its tip."""
    last = arm.joints[-1]
    xx, yy, zz, xy, xz, yz = last.link.inertia_kg_m2
    mass, a = last.link.mass_kg + mass_kg, last.a_m
    x, y, z = (last.link.mass_kg * s for s in last.link.com_m)
    com = ((x + mass_kg * a) / mass, y / mass, z / mass) if mass else last.link.com_m
    turning = mass_kg * a * a
    link = replace(last.link, mass_kg=mass, com_m=com, inertia_kg_m2=(xx, yy + turning, zz + turning, xy, xz, yz))
    return replace(arm, joints=(*arm.joints[:-1], replace(last, link=link)))


EFFECT = EffectKind(
    name="payload",
    sentence="the tip carries a mass",
    place="arm",
    parameters=(
        Parameter("mass_kg", "kg", 0.0, 1e3, linear=True, neutral=0.0),
        TRIALS,
        SINCE,
    ),
    taken_for=("external_push", "gain_error", "rotor_inertia"),
    whole=True,
    tip_mass="mass_kg",
)
