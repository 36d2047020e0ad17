"""The shape of a segment's markers, by generalised Procrustes analysis of frames with gaps.

Poses that bring a shape nearest to each frame and the shape that is the mean of the frames, brought back by their
poses, are found in turn (Gower 1975; Söderkvist and Wedin 1993 for the poses). A marker that no frame shows beside
three others of the first frame joins as soon as the shape has grown to reach it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.functional.rigid_fit import LEAST_WIDTH_M, Poses, fit_poses
from limbcal.errors import DataError

#: Frames, evenly spread, that a shape is learnt from at the most: its error is that of skin, not of counting.
_MOST_FRAMES = 2000
_MOST_ITERATIONS = 200
#: A frame is doubted whose rms residual is this much larger than the median, and larger than a wobble of skin [m]:
#: soft tissue moves by 10 mm and more where it is thickest (Leardini et al. 2005), a wrong label by much more.
_DOUBTFUL, _DOUBTFUL_M = 5.0, 0.01
#: Iterations end where the shape moves by less [m]; a marker is measured to some tenths of a millimetre.
_CONVERGED_M = 1e-6


@dataclass(frozen=True)
class Template:
    """A segment's markers in the frame of the segment, whose origin is their mean.

    Attributes
    ----------
    markers : tuple of str
    points_m : (n_marker, 3)
        NaN for a marker that could not be placed.
    rms_m : (n_marker,)
        How far the marker wandered from there, relative to the others.
    """

    markers: tuple[str, ...]
    points_m: Floats
    rms_m: Floats

    @property
    def missing(self) -> tuple[str, ...]:
        """Markers that could not be placed, for they were never seen together with three others."""
        return tuple(m for m, x in zip(self.markers, self.points_m, strict=True) if not np.isfinite(x).all())

    def poses(self, measured_m: Floats) -> Poses:
        """Return the segment's pose in every frame of ``(n_frame, n_marker, 3)``."""
        return fit_poses(self.points_m, measured_m)


def learn_template(markers: Sequence[str], trials_m: Sequence[Floats]) -> Template:
    """Learn the shape of a segment's markers from all trials together.

    Parameters
    ----------
    markers : sequence of str
    trials_m : sequence of (n_frame, n_marker, 3)

    Raises
    ------
    DataError
        If no frame shows three markers that are not in a line.
    """
    frames = np.concatenate([np.asarray(trial, dtype=np.float64) for trial in trials_m])
    seen = np.isfinite(frames).all(axis=2)
    frames = frames[seen.sum(axis=1) >= 3]
    seen = np.isfinite(frames).all(axis=2)
    if not len(frames):
        raise DataError(f"markers {', '.join(markers)}: never three of them in one frame, expected at least three")
    chosen = frames[np.linspace(0, len(frames) - 1, min(len(frames), _MOST_FRAMES)).round().astype(int)]
    points = _shape(_fullest_frame(frames, seen, markers), chosen)
    # once more without the frames that are far off: there a marker leapt, or was another one
    rms = fit_poses(points, chosen).rms_m
    chosen = chosen[~(rms > doubtful_rms_m(rms))]
    points = _with_seldom_seen(_shape(points, chosen), frames)
    points = points - np.nanmean(points, axis=0)
    return Template(tuple(markers), points, fit_poses(points, chosen).marker_rms_m)


def doubtful_rms_m(rms_m: Floats) -> float:
    """Return from which rms residual on a frame is doubted, given those of all frames, (n_frame,) with NaN [m]."""
    known = rms_m[np.isfinite(rms_m)]
    return max(_DOUBTFUL_M, _DOUBTFUL * float(np.median(known))) if len(known) else np.inf


def _shape(points: Floats, frames: Floats) -> Floats:
    """Return the shape that poses and means in turn end at."""
    for _ in range(_MOST_ITERATIONS):
        mean = _mean_shape(points, fit_poses(points, frames), frames)
        step = np.abs(mean - points)
        grown = np.isfinite(mean).sum() > np.isfinite(points).sum()
        points = mean
        if not grown and np.nanmax(step) < _CONVERGED_M:
            break
    return points


def _with_seldom_seen(points: Floats, frames: Floats) -> Floats:
    """Return the shape with the markers that none of the chosen frames could place."""
    for _ in points:
        mean = _mean_shape(points, fit_poses(points, frames), frames)
        new = np.isnan(points) & np.isfinite(mean)
        if not new.any():
            break
        points = np.where(new, mean, points)
    return points


def _fullest_frame(frames: Floats, seen: np.ndarray, markers: Sequence[str]) -> Floats:
    """Return the frame with the most markers, and of those the one that spreads them widest off a line."""
    weight = seen / seen.sum(axis=1, keepdims=True)
    filled = np.where(seen[..., None], frames, 0.0)
    centred = np.where(seen[..., None], filled - np.einsum("nm,nmi->ni", weight, filled)[:, None], 0.0)
    variance = np.linalg.eigvalsh(np.einsum("nm,nmi,nmj->nij", weight, centred, centred))
    width = np.sqrt(np.maximum(variance[:, :2].sum(axis=1), 0.0))
    if not np.max(width) >= LEAST_WIDTH_M:
        found = f"within {1e3 * np.max(width):.1f} mm rms of a straight line"
        raise DataError(f"markers {', '.join(markers)}: {found}, expected three that are not in a line")
    wide = width >= LEAST_WIDTH_M
    most = seen[wide].sum(axis=1).max()
    best = np.flatnonzero(wide & (seen.sum(axis=1) == most))
    # the median width: a frame of its own kind may have a marker that jumped
    first = best[np.argsort(width[best], kind="stable")[len(best) // 2]]
    return np.asarray(frames[first] - np.nanmean(frames[first], axis=0))


def _mean_shape(points: Floats, poses: Poses, frames: Floats) -> Floats:
    """Return the mean of the frames brought back to the segment; markers not yet placed join by their own mean."""
    back = np.einsum("nji,nmj->nmi", poses.R, frames - poses.p[:, None, :])
    count = np.isfinite(back[..., 0]).sum(axis=0)[:, None]
    mean = np.where(count > 0, np.nansum(back, axis=0) / np.maximum(count, 1), points)
    return np.asarray(mean)
