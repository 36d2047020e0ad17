"""The pose of a rigid body that brings its points nearest to measured ones, for all frames at once.

Least squares over rotations has a closed answer in the 3 × 3 cross-dispersion (`nearest_rotation`; Kabsch 1976;
Söderkvist and Wedin 1993). Points that were not seen in a frame have no weight there.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.functional.nearest_rotation import nearest_rotations

#: Least rms distance of the seen points from the straight line nearest to them [m]. Skin lets a marker wander by
#: some millimetres (Leardini et al. 2005); on points nearer to a line than that, the turn about the line is
#: arbitrary.
LEAST_WIDTH_M = 0.005


@dataclass(frozen=True)
class Poses:
    """The pose of a segment in the world, frame by frame; NaN where too few points were seen.

    Attributes
    ----------
    R : (n_frame, 3, 3)
        Segment to world.
    p : (n_frame, 3)
        Origin of the segment's frame in the world [m].
    residual_m : (n_frame, n_point, 3)
        Measured less posed position, in the segment's frame.
    """

    R: Floats
    p: Floats
    residual_m: Floats

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which frames have a pose, (n_frame,) bool."""
        return np.isfinite(self.p[:, 0])

    @property
    def rms_m(self) -> Floats:
        """Root mean square distance of the seen points from where the pose has them, (n_frame,)."""
        seen = np.isfinite(self.residual_m[..., 0])
        squares = np.where(seen, np.sum(np.nan_to_num(self.residual_m) ** 2, axis=2), 0.0).sum(axis=1)
        count = seen.sum(axis=1)
        return np.where(count > 0, np.sqrt(squares / np.maximum(count, 1)), np.nan)

    @property
    def marker_rms_m(self) -> Floats:
        """Root mean square distance of each point from where the poses have it, (n_point,); NaN if never seen."""
        seen = np.isfinite(self.residual_m[..., 0])
        squares = np.where(seen, np.sum(np.nan_to_num(self.residual_m) ** 2, axis=2), 0.0).sum(axis=0)
        count = seen.sum(axis=0)
        return np.where(count > 0, np.sqrt(squares / np.maximum(count, 1)), np.nan)

    def without(self, frames: NDArray[np.bool_]) -> "Poses":
        """Return the poses with none in some frames, (n_frame,) bool."""
        return Poses(
            np.where(frames[:, None, None], np.nan, self.R),
            np.where(frames[:, None], np.nan, self.p),
            np.where(frames[:, None, None], np.nan, self.residual_m),
        )

    def to_world(self, point_m: Floats) -> Floats:
        """Return where a point of the segment is in the world, (n_frame, 3)."""
        return np.asarray(self.R @ point_m + self.p)

    def to_segment(self, points_m: Floats) -> Floats:
        """Return where points in the world, (n_frame, 3), are in the segment's frame, (n_frame, 3)."""
        return np.asarray(np.einsum("nji,nj->ni", self.R, points_m - self.p))


def fit_poses(points_m: Floats, measured_m: Floats) -> Poses:
    """Find the pose in every frame.

    Parameters
    ----------
    points_m : (n_point, 3)
        In the segment's frame; NaN where a point's place is not known.
    measured_m : (n_frame, n_point, 3)
        In the world; NaN where it was not seen.

    Returns
    -------
    Poses
        NaN in frames with fewer than three points, or with points too near to a straight line.
    """
    seen = np.asarray(np.isfinite(measured_m).all(axis=2) & np.isfinite(points_m).all(axis=1))
    weight = seen / np.maximum(seen.sum(axis=1, keepdims=True), 1)
    local = np.nan_to_num(points_m)
    world = np.where(seen[..., None], measured_m, 0.0)
    local_mean = weight @ local
    world_mean = np.einsum("nm,nmi->ni", weight, world)
    # sums of products about the means; unseen points have weight 0
    dispersion = (
        np.einsum("nm,nmi,mj->nij", weight, world, local) - world_mean[:, :, None] * local_mean[:, None, :]
    )
    good = (seen.sum(axis=1) >= 3) & (_widths(local, seen) >= LEAST_WIDTH_M)
    R = np.where(good[:, None, None], nearest_rotations(dispersion), np.nan)
    p = world_mean - np.einsum("nij,nj->ni", R, local_mean)
    residual = (
        np.einsum("nji,nmj->nmi", R, np.where(seen[..., None], measured_m, np.nan) - p[:, None, :]) - points_m
    )
    return Poses(R, p, residual)


def _widths(local: Floats, seen: NDArray[np.bool_]) -> Floats:
    """Return the rms distance of the seen points from the straight line nearest to them, (n_frame,).

    Most frames show the same points.
    """
    together, which = np.unique(seen, axis=0, return_inverse=True)
    weight = together / np.maximum(together.sum(axis=1, keepdims=True), 1)
    mean = weight @ local
    own = np.einsum("nm,mi,mj->nij", weight, local, local) - mean[:, :, None] * mean[:, None, :]
    width: Floats = np.sqrt(np.maximum(np.linalg.eigvalsh(own)[:, :2].sum(axis=1), 0.0))
    return width[which.ravel()]
