"""How pelvis and thorax stand in their markers when a person stands upright: the posture of all-zero angles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.limb.base_orientation import seen_or_posed, world_up
from fitter.limb.limb_trials import LimbTrials
from fitter.limb.nan_statistics import nan_mean, nan_median
from limbcal.errors import NotIdentifiable
from limbcal.note import Note

#: A frame is taken for upright whose pelvis is within this of where it is at its highest above the feet [m]: knees
#: that are bent by less than that lower it by no more [deg]. The highest is a quantile, for somebody who jumps.
_UPRIGHT_M, _HIGHEST = 0.02, 0.95
_BENT_DEG = 20.0
#: Landmarks whose line points to the left, by segment.
_ACROSS = {"pelvis": ("asis", "psis"), "thorax": ("acromion",)}


@dataclass(frozen=True)
class Stance:
    """The upright frames of all recordings.

    Attributes
    ----------
    rows : (n_frame,) bool
    world : (3, 3)
        Forward, left and up of the person as columns, in the world, in the trial that stands longest.
    axes : mapping of str to (3, 3)
        The same in the frames of pelvis and thorax.
    notes : tuple of Note
    """

    rows: NDArray[np.bool_]
    world: Floats
    axes: dict[str, Floats]
    notes: tuple[Note, ...]


def stance(trials: LimbTrials) -> Stance:
    """Find where a person stands upright, and how pelvis and thorax stand then.

    Raises
    ------
    NotIdentifiable
        If pelvis or thorax have no pose, no frame shows the pelvis', or no landmark tells left from right.
    """
    for segment in ("pelvis", "thorax"):
        if segment not in trials.motions:
            there = ", ".join(trials.segments.get(segment, ())) or "no marker"
            raise NotIdentifiable(
                f"the {segment} has {there} in the recordings, expected three markers that are not in a line: "
                "without its pose nothing else of the body has a place"
            )
    up = world_up(trials.up)
    pelvis = trials.motions["pelvis"].whole
    feet = [m for s, on_it in trials.segments.items() if s.startswith("foot") for m in on_it]
    height = pelvis.p @ up
    if feet:
        height = height - nan_mean(np.stack([trials.of(m) @ up for m in feet], axis=1), axis=1)
    known = np.isfinite(height)
    if not known.any():
        raise NotIdentifiable("no frame shows the pose of the pelvis, expected three of its markers in some frame")
    rows = known & (height >= np.quantile(height[known], _HIGHEST) - _UPRIGHT_M)
    left = _leftward(trials, "pelvis")
    if left is None or not np.isfinite(left[rows]).any():
        raise NotIdentifiable(
            "no landmark tells left from right of the pelvis, expected asis_right and asis_left in the marker set"
        )
    trial = np.concatenate([np.full(len(t), i) for i, t in enumerate(trials.t)])
    most = int(np.argmax(np.bincount(trial[rows], minlength=len(trials.t))))
    world = _upright_axes(nan_median(left[rows & (trial == most)]), up)
    axes, notes = dict[str, Floats](), list[Note]()
    for segment in ("pelvis", "thorax"):
        R = trials.motions[segment].whole.R
        across = _leftward(trials, segment)
        if across is None or not np.isfinite(across[rows]).any():
            across = left
            text = f"no landmark tells left from right of the {segment}: it is taken to face ahead when upright"
            notes.append(Note("base_axes", text))
        local = [
            nan_median(np.einsum("nji,nj->ni", R[rows], x)) for x in (across[rows], np.tile(up, (rows.sum(), 1)))
        ]
        if not np.isfinite(local).all():
            raise NotIdentifiable(f"no upright frame shows the pose of the {segment}, expected some")
        axes[segment] = _upright_axes(local[0], local[1])
    return Stance(rows, world, axes, tuple(notes))


def bent_knees(knees: Floats) -> tuple[Note, ...]:
    """Say if knees are bent even where a person stands most upright: no frame shows the posture of zero angles.

    Parameters
    ----------
    knees : (n_frame, n_knee) [rad]
        In the frames that stand most upright.
    """
    bent = np.degrees(np.abs(nan_median(knees))).max(initial=0.0)
    if not bent > _BENT_DEG:
        return ()
    text = (
        f"a knee is bent by {bent:.0f}° in the frames that stand most upright: none shows an upright stance, "
        "in which pelvis and trunk are taken to stand straight and all angles to be near zero; record one"
    )
    return (Note("stance", text),)


def _leftward(trials: LimbTrials, segment: str) -> Floats | None:
    """Return the way from right to left of a segment in the world, (n_frame, 3)."""
    for name in _ACROSS[segment]:
        marks = [trials.landmarks.get(f"{name}_{side}") for side in ("left", "right")]
        if all(marks):
            return np.asarray(seen_or_posed(trials, str(marks[0])) - seen_or_posed(trials, str(marks[1])))
    return None


def _upright_axes(left: Floats, up: Floats) -> Floats:
    """Return forward, left and up as columns, up kept."""
    up = up / np.linalg.norm(up)
    across = left - (left @ up) * up
    across = across / np.linalg.norm(across)
    return np.column_stack([np.cross(across, up), across, up])
