"""Play in the transmission: the motor's side leads by half the gap, in the direction in which it pushes.

The angle that is measured and controlled is the motor's. A motor without inertia crosses the gap in `CROSSING_S`,
or more slowly where its own controller holds it back: in the gap nothing is transmitted, so it moves such that the
controller asks for nothing.
"""

from arm.effects.effect import EffectKind, Parameter
from arm.effects.joint_numbers import GAP

#: Time constant with which a motor that nothing holds back crosses the gap.
CROSSING_S = 0.002

EFFECT = EffectKind(
    name="backlash",
    sentence="the transmission has play",
    place="transmission",
    parameters=(Parameter("gap_rad", "rad", 0.0, 1.0, neutral=0.0),),
    taken_for=("joint_elasticity", "stribeck"),
    simulated={GAP: "gap_rad"},
)
