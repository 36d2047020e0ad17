"""A segment over all trials: its template and its poses."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.functional.pose_error import marker_variance, turn_variance
from fitter.functional.rigid_fit import Poses
from fitter.functional.template import Template, doubtful_rms_m, learn_template
from limbcal.note import Note


@dataclass(frozen=True)
class SegmentMotion:
    """A segment's markers and its pose in every frame of every trial.

    Attributes
    ----------
    name : str
        As marker sets name segments, such as ``thigh_right``.
    template : Template
    trials : tuple of Poses
    notes : tuple of Note
        What was left out.
    variance_m2 : float
        Of a marker along each axis, as its residuals show it.
    turn_variance_rad2 : float
        Of the segment's turn about an axis that this makes.
    """

    name: str
    template: Template
    trials: tuple[Poses, ...]
    notes: tuple[Note, ...] = ()
    variance_m2: float = field(init=False)
    turn_variance_rad2: float = field(init=False)

    def __post_init__(self) -> None:
        whole = self.whole
        object.__setattr__(self, "variance_m2", marker_variance(whole))
        turn = turn_variance(self.template.points_m, whole, self.variance_m2)
        object.__setattr__(self, "turn_variance_rad2", turn)

    @property
    def whole(self) -> Poses:
        """All trials, one after the other."""
        return Poses(*(np.concatenate([getattr(t, n) for t in self.trials]) for n in ("R", "p", "residual_m")))

    def place(self, trials_m: Sequence[Floats]) -> Floats:
        """Return where a point of the world, such as a landmark, is in this segment: its median, (3,) [m].

        Parameters
        ----------
        trials_m : sequence of (n_frame, 3)
            NaN where it was not seen; NaN is returned if it never was together with the segment.
        """
        local = np.concatenate([t.to_segment(x) for t, x in zip(self.trials, trials_m, strict=True)])
        seen = np.isfinite(local).all(axis=1)
        return np.median(local[seen], axis=0) if seen.any() else np.full(3, np.nan)


def segment_motion(name: str, markers: Sequence[str], trials_m: Sequence[Floats]) -> SegmentMotion:
    """Learn a segment's template from all trials and find its poses in each, but for frames far off their shape.

    Parameters
    ----------
    name : str
    markers : sequence of str
    trials_m : sequence of (n_frame, n_marker, 3)
        NaN where a marker was not seen.

    Raises
    ------
    DataError
        If no frame shows three markers that are not in a line.
    """
    template = learn_template(markers, trials_m)
    trials = [template.poses(trial) for trial in trials_m]
    limit_m = doubtful_rms_m(np.concatenate([poses.rms_m for poses in trials]))
    doubtful = [poses.rms_m > limit_m for poses in trials]
    kept = tuple(poses.without(frames) for poses, frames in zip(trials, doubtful, strict=True))
    return SegmentMotion(name, template, kept, _notes(name, template, doubtful, limit_m))


def _notes(
    name: str, template: Template, doubtful: Sequence[NDArray[np.bool_]], limit_m: float
) -> tuple[Note, ...]:
    notes = []
    if template.missing:
        text = f"{name}: {', '.join(template.missing)} never seen beside three others of the segment, so left out"
        notes.append(Note("unplaced_marker", text, columns=template.missing))
    n = sum(int(frames.sum()) for frames in doubtful)
    if n:
        where = next(f"frame {int(np.argmax(f)) + 1} of trial {i + 1}" for i, f in enumerate(doubtful) if f.any())
        text = (
            f"{name}: in {n} of {sum(map(len, doubtful))} frames, {where} the first, its markers are more than "
            f"{1e3 * limit_m:.0f} mm rms from their usual shape, likely a wrong label or a filled gap; left out"
        )
        notes.append(Note("doubted_pose", text, columns=template.markers))
    return tuple(notes)
