"""A geared rotor that turns with the joint: M[i, i] grows by its inertia, and nothing else changes."""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_numbers import ROTOR

EFFECT = EffectKind(
    name="rotor_inertia",
    sentence="a geared rotor turns with the joint, which the links don't carry",
    place="arm",
    parameters=(Parameter("inertia_kg_m2", "kg m^2", 0.0, 1e3, linear=True, neutral=0.0),),
    taken_for=("gain_error", "payload"),
    usual=True,
    simulated={ROTOR: "inertia_kg_m2"},
)
