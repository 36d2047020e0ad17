"""Leaving out each marker of a frame of no interest, so that the kernel is compiled."""

from dataclasses import replace

import numpy as np

from arm.body.landmarks import limb_map
from arm.body.limbs import MEAN_PERSON, limb
from fitter.limb.free_geometry import geometry_of
from fitter.limb.initial_geometry import angle_prior
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import SWAY, Frames, MarkerModel
from fitter.marker_diagnosis.left_out import left_out

_MARKERS, _STD_M = 4, 0.01


def warm_up() -> None:
    """Ask of markers of one segment where the others have each of them."""
    arm = limb(replace(MEAN_PERSON, preset="human-leg-right"))
    place = 0.1 * np.eye(_MARKERS, 3)
    names, links = tuple(f"m{k}" for k in range(_MARKERS)), np.zeros(_MARKERS, dtype=np.int64)
    markers = MarkerModel(names, links, place, np.full(_MARKERS, _STD_M))
    chain, q = markers.chain(geometry_of(arm)), np.zeros((1, SWAY + arm.n_joint))
    frames = Frames(
        np.empty((1, _MARKERS, 3)), np.eye(3)[None], np.zeros((1, 3)), np.zeros(1, dtype=np.int64), np.zeros(1)
    )
    frames = frames._replace(y=predicted(chain, frames, q))
    left_out(chain, frames, markers.std, angle_prior(arm, limb_map(arm.name, arm.n_joint), 0.0), q)
