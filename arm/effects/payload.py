"""A mass at the tip, in some trials or from some time on: a point at the far end of the last link.

With ``trials`` it is there in those, by number or by name, and in no others; with ``since_s`` from that time on;
with both, from that time of the first of these trials on, and in the others all along; with neither, always.
"""

import math
from dataclasses import replace

from arm.effects.effect import LATEST_S, EffectKind, Parameter, Values, number
from arm.effects.trials import TRIALS, AnyTrial, acts_in, is_trial, trials_of
from arm.model import Arm


def loaded_from(values: Values, trial: AnyTrial) -> float:
    """Return the time from which the mass is there in a trial [s], on its clock; infinite where it is not."""
    if not acts_in(values, trial):
        return math.inf
    listed = trials_of(values)
    begins = not listed or is_trial(listed[0], trial)
    return number(values, "since_s") if begins and "since_s" in values else -math.inf


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
        Parameter("since_s", "s", -LATEST_S, LATEST_S, optional=True),
    ),
    taken_for=("external_push", "gain_error", "rotor_inertia"),
    whole=True,
)
