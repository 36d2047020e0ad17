"""The pose of the segment that carries a limb's base, frame by frame.

Three markers or more give it a pose of its own. One or two give it a place; it then keeps its orientation in the
world, which a ball joint takes up. None: it stands.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from arm.model import Floats
from fitter.functional.rigid_fit import fit_poses
from fitter.limb.limb_trials import LimbTrials
from limbcal.errors import NotIdentifiable
from limbcal.note import Note

#: The reach of a very tall person, and a marker beyond its end, against the mean person's: assumed.
_LONGER = 1.5
#: Quantiles of places between which a marker goes, without frames in which it leaps.
_SURE = (0.01, 0.99)


@dataclass(frozen=True)
class BaseMotion:
    """The segment that carries the base.

    Attributes
    ----------
    segment : str or None
        None where it stands.
    markers : tuple of str
    points_m : (n_marker, 3)
        In the segment's frame.
    R, p : (n_frame, 3, 3), (n_frame, 3)
        Segment to world in all trials, one after the other; NaN where it is not known.
    notes : tuple of Note
    """

    segment: str | None
    markers: tuple[str, ...]
    points_m: Floats
    R: Floats
    p: Floats
    notes: tuple[Note, ...] = ()


def base_motion(trials: LimbTrials, segment: str) -> BaseMotion:
    """Return how the segment that carries the base moved."""
    if segment in trials.motions:
        motion = trials.motions[segment]
        whole, template = motion.whole, motion.template
        placed = np.asarray(np.isfinite(template.points_m).all(axis=1))
        markers = tuple(m for m, there in zip(template.markers, placed.tolist(), strict=True) if there)
        return BaseMotion(segment, markers, template.points_m[placed], whole.R, whole.p)
    markers = trials.segments.get(segment, ())
    y = np.stack([trials.of(m) for m in markers], axis=1) if markers else np.empty((len(trials.whole), 0, 3))
    points = _apart(y)
    R, p = poses_of(points, y)
    if not markers:
        text = f"no marker of {segment} is in the recordings: it is taken to stand still in the world"
        return BaseMotion(None, (), points, R, p, (Note("base_untracked", text),))
    text = (
        f"{segment} has {len(markers)} marker{'s' * (len(markers) > 1)}, expected three for a pose of its own: it "
        "moves with them and is taken to keep its orientation in the world"
    )
    return BaseMotion(segment, markers, points, R, p, (Note("base_orientation", text, columns=markers),))


def require_standing(trials: LimbTrials, base: BaseMotion, wanted: str, first: str, reach_m: float) -> None:
    """Refuse a base without markers whose limb goes farther than it reaches from where that stands.

    Parameters
    ----------
    trials : LimbTrials
    base : BaseMotion
    wanted : str
        The segment that carries the base.
    first : str
        The segment that hangs on it.
    reach_m : float
        How far its end is from the base, about.

    Raises
    ------
    NotIdentifiable
        If it does.
    """
    if base.segment is not None:
        return
    for marker in trials.segments.get(first, ()):
        y = trials.of(marker)
        seen = y[np.isfinite(y[:, 0])]
        goes = float(np.max(np.diff(np.quantile(seen, _SURE, axis=0), axis=0), initial=0.0)) if len(seen) else 0.0
        if goes > 2.0 * _LONGER * reach_m:
            raise NotIdentifiable(
                f"no marker of {wanted} is in the recordings, and {marker} on {first} goes {goes:.1f} m, farther "
                f"than where {wanted} stands still: expected markers of {wanted}, by the names that the marker "
                "set has or in a marker set of your own"
            )


def poses_of(points_m: Floats, measured_m: Floats) -> tuple[Floats, Floats]:
    """Return the poses of a segment with few markers or many, R (n_frame, 3, 3) and p (n_frame, 3).

    Parameters
    ----------
    points_m : (n_marker, 3)
        In the segment's frame; of fewer than three markers in a frame that is parallel to the world's.
    measured_m : (n_frame, n_marker, 3)
    """
    n = len(measured_m)
    if len(points_m) >= 3:
        poses = fit_poses(points_m, measured_m)
        return poses.R, poses.p
    R = np.tile(np.eye(3), (n, 1, 1))
    if not len(points_m):
        return R, np.zeros((n, 3))
    away = measured_m - points_m
    seen = np.isfinite(away[..., 0])
    count = seen.sum(axis=1)[:, None]
    p = np.where(count > 0, np.where(seen[..., None], away, 0.0).sum(axis=1) / np.maximum(count, 1), np.nan)
    R[~seen.any(axis=1)] = np.nan
    return R, p


def _apart(y: Floats) -> Floats:
    """Return where one or two markers are from their middle, in the world's axes, (n_marker, 3) [m]."""
    if y.shape[1] < 2:
        return np.zeros((y.shape[1], 3))
    both = np.isfinite(y).all(axis=(1, 2))
    middle = y[both].mean(axis=1, keepdims=True)
    return np.asarray(np.median(y[both] - middle, axis=0)) if both.any() else np.zeros((y.shape[1], 3))


def markers_in(points_m: Floats, R: Floats, p: Floats) -> Floats:
    """Return points of a segment in a frame that stands in it with pose ``R, p``, (n, 3) [m]."""
    return np.asarray((points_m - p) @ R)


def quaternions(R: Floats) -> Floats:
    """Return unit quaternions w, x, y, z of rotations (n, 3, 3), without leaps of sign, (n, 4); NaN stays."""
    known = np.isfinite(R).all(axis=(1, 2))
    out = np.full((len(R), 4), np.nan)
    if known.any():
        xyzw = Rotation.from_matrix(R[known]).as_quat()
        wxyz = xyzw[:, [3, 0, 1, 2]]
        flips = np.cumprod(
            np.concatenate([[1.0], np.where(np.sum(wxyz[1:] * wxyz[:-1], axis=1) < 0.0, -1.0, 1.0)])
        )
        out[known] = wxyz * flips[:, None]
    return out


def named(markers: Sequence[str], points_m: Floats) -> dict[str, list[float]]:
    """Return places by marker, as JSON has them."""
    return {name: [float(x) for x in place] for name, place in zip(markers, points_m, strict=True)}
