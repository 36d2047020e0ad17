"""Where a limb's base is while its markers do not tell it: the limb carries it along.

Over seconds a person goes metres: between the frames that show the base a straight line is no guess of its place.
Its orientation is interpolated, for a ball joint takes up whatever it is; its place is where the markers that are
seen, the limb's and what there is of the base's, leave it.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from arm.marker_kinematics import MarkerChain
from arm.model import Floats
from fitter.limb.inverse_kinematics import follow, link_poses
from fitter.limb.marker_observations import SWAY, AnglePrior, Frames
from fitter.limb.nan_statistics import nan_median


def interpolated(R: Floats, p: Floats) -> tuple[Floats, Floats]:
    """Return poses, R (n, 3, 3) and p (n, 3), with those in between where they are NaN; one at least is known."""
    known = np.flatnonzero(np.isfinite(p[:, 0]))
    at = np.clip(np.arange(len(p)), known[0], known[-1])
    place = np.column_stack([np.interp(at, known, p[known, axis]) for axis in range(3)])
    if len(known) == 1:
        return np.ascontiguousarray(R[np.full(len(p), known[0])]), place
    return np.ascontiguousarray(Slerp(known, Rotation.from_matrix(R[known]))(at).as_matrix()), place


def carried_along(y: Floats, known: NDArray[np.bool_], p: Floats) -> Floats:
    """Return about where the base is: as far from the markers that are seen as before and after the gap.

    Parameters
    ----------
    y : (n_frame, m, 3) [m]
        All markers, NaN where one is not seen.
    known : (n_frame,) of bool
        Where the base has a pose of its own.
    p : (n_frame, 3) [m]
        Its place there, and any elsewhere.

    Returns
    -------
    (n_frame, 3) [m]
    """
    frames, guesses = np.arange(len(y)), np.full(y.shape, np.nan)
    for m in range(y.shape[1]):
        seen = np.isfinite(y[:, m, 0])
        both = np.flatnonzero(seen & known)
        if len(both):
            away = [np.interp(frames, both, (y[both, m] - p[both])[:, axis]) for axis in range(3)]
            guesses[:, m] = y[:, m] - np.column_stack(away)
    is_estimated = ~known & np.isfinite(guesses[..., 0]).any(axis=1)
    found = np.where(known[:, None], p, np.nan)
    found[is_estimated] = nan_median(guesses[is_estimated].transpose(1, 0, 2))
    there = np.flatnonzero(np.isfinite(found[:, 0]))
    return np.column_stack([np.interp(frames, there, found[there, axis]) for axis in range(3)])


def carried_by_limb(
    chain: MarkerChain,
    frames: Frames,
    std_m: Floats,
    prior: AnglePrior,
    known: NDArray[np.bool_],
    seed: int,
) -> Floats:
    """Return sway and angles that bring the limb to its markers wherever the base may be, (n_frame, 6 + n_joint).

    Parameters
    ----------
    chain : MarkerChain
        With the base's sway before the limb's joints.
    frames : Frames
        With interpolated poses of the base where they are not known.
    std_m : (m,)
    prior : AnglePrior
        See `fitter.limb.marker_observations.base_anywhere`.
    known : (n_frame,) of bool
        Where the base has a pose of its own.
    seed : int
        Of the postures that angles begin from.
    """
    p = carried_along(frames.y, known, frames.p)
    q = follow(chain, frames._replace(p=p), std_m, prior, seed)
    n = SWAY // 2
    along = link_poses(chain, frames, q)[0][:, :n, :, 2]
    q[:, :n] += np.einsum("nij,nj->ni", along, p - frames.p)
    return q
