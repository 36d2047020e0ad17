"""Skin that slides over the bone: a marker's place on its link goes with a joint's position.

The marker is where the arm file has it while the joint is at ``rest``; from there it goes along its link's axes by
so much a radian (or metre) of the joint.
"""

import numpy as np

from arm.effects.effect import EffectKind, Parameter, number, vector
from arm.effects.trials import TRIALS
from arm.model import Effect, Floats

SLOPES = ("x_m_rad", "y_m_rad", "z_m_rad")


def slid(effect: Effect, q: Floats) -> Floats:
    """Return by how much a marker has slid on its link, (n_sample, 3) [m], at positions (n_sample, n_joint)."""
    joint = int(number(effect.parameters, "joint")) - 1
    turned = q[:, joint] - number(effect.parameters, "rest_rad")
    return np.outer(turned, vector(effect.parameters, *SLOPES))


EFFECT = EffectKind(
    name="soft_tissue",
    sentence="skin slides over the bone and takes the marker with it",
    place="marker",
    parameters=(
        *(Parameter(name, "m/rad", -1.0, 1.0, linear=True, neutral=0.0) for name in SLOPES),
        Parameter("rest_rad", "rad", -1e3, 1e3),
        Parameter("joint", "1", 1.0, 1e6),
        TRIALS,
    ),
    taken_for=("marker_moved",),
    slid=slid,
)
