"""Which end of a tree each plate is under, by where its force acts while it is loaded."""

from collections.abc import Sequence

import numpy as np

from arm.kinematics import axis_frames
from arm.model import Arm, Floats
from arm.moving_base import BaseState
from protocol.markers.wrench_files import EMPTY_N, PlateWrench


def ends(arm: Arm) -> list[int]:
    """Return the links, from 0, that no other hangs on."""
    return [i for i in range(arm.n_joint) if i not in arm.parents]


def placed(
    arm: Arm, t: Floats, q: Floats, base: BaseState, plates: Sequence[PlateWrench]
) -> list[tuple[PlateWrench, int]]:
    """Return each loaded plate with the joint, from 1, of the end nearest to its force, in the median.

    Parameters
    ----------
    arm : Arm
    t : (n_sample,) [s]
    q : (n_sample, n_joint) [rad or m]
    base : BaseState
    plates : sequence of PlateWrench
        A plate that carries nothing meanwhile is under none.
    """
    some = ends(arm)
    joints = axis_frames(arm, np.ascontiguousarray(q))[..., :3, 3][:, some]
    origins = np.einsum("nij,nlj->nli", base.R, joints) + base.p[:, None]
    found = []
    for plate in plates:
        force, point, _ = plate.at(t)
        away = np.linalg.norm(origins - point[:, None], axis=2)
        loaded = (np.linalg.norm(np.nan_to_num(force), axis=1) > EMPTY_N) & np.isfinite(away).all(axis=1)
        if loaded.any():
            found.append((plate, some[int(np.argmin(np.median(away[loaded], axis=0)))] + 1))
    return found
