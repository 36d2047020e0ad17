"""A joint's centre from functional trials, with its error and with what the motion does not determine.

The error comes from disjoint trials or parts of trials (`disjoint`), and from how far turns of the skin draw a
centre towards the markers (`attenuation`). It knows nothing of skin that goes with the joint's angle and alike
in all trials.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.functional.advice import motion_for_centre
from fitter.functional.attenuation import skin_turns, without_attenuation
from fitter.functional.disjoint import coverage_factor, jackknife, rms_apart
from fitter.functional.pose_error import pose_covariance
from fitter.functional.relative_motion import RelativeMotion, Turning, part_sums, turning
from fitter.functional.score import centre, revealed_basis
from fitter.functional.segment_motion import SegmentMotion
from fitter.functional.sufficient_rotation import (
    joint_motion,
    least_turn_rad,
    moved_trials,
    nothing_turned,
    trial_notes,
)
from limbcal.errors import NotIdentifiable
from limbcal.note import Note

#: Iterations of what depends on the centre, weights and attenuation: the second moves it by tenths of a
#: millimetre.
_ITERATIONS = 3


@dataclass(frozen=True)
class FunctionalCentre:
    """The centre of a joint.

    Attributes
    ----------
    joint, parent, child : str
        Names of the joint and of its segments.
    method : str
        ``"score"`` or ``"weighted score"``.
    in_parent_m, in_child_m : (3,)
        The centre in the frames of the segments' templates.
    covariance_m2 : (6, 6)
        Of both, from disjoint parts and of the attenuation; NaN where there are fewer than two parts.
    attenuation_m : (6,)
        How far both would move without what turns of the skin take off the rotations.
    n_part : int
        Parts behind it: ``coverage_factor(n_part)`` standard deviations make the 95 % interval.
    apart_m : float
        How far disjoint trials (halves of the only one) disagree on the place in the parent, rms.
    rms_m : float
        How far the two segments' centres are from each other, rms over the frames.
    turning : Turning
        What turned; ``turning.in_parent[k]`` is a direction in the parent.
    unobservable : (3,) bool
        Along which of these directions the place is not revealed.
    notes : tuple of Note
    """

    joint: str
    parent: str
    child: str
    method: str
    in_parent_m: Floats
    in_child_m: Floats
    covariance_m2: Floats
    attenuation_m: Floats
    n_part: int
    apart_m: float
    rms_m: float
    turning: Turning
    unobservable: NDArray[np.bool_]
    notes: tuple[Note, ...]

    @property
    def std_m(self) -> float:
        """Root mean square length of the error of the place in the parent [m]."""
        return float(np.sqrt(np.trace(self.covariance_m2[:3, :3])))

    @property
    def half_width_m(self) -> Floats:
        """Half-widths of the 95 % intervals of the place in the parent, (3,) [m]; infinite where not revealed."""
        half = coverage_factor(self.n_part) * np.sqrt(np.diag(self.covariance_m2[:3, :3]))
        along = np.abs(self.turning.in_parent[self.unobservable]).max(axis=0, initial=0.0) > 1e-6
        return np.where(along, np.inf, half)

    def document(self, markers: SegmentMotion) -> dict[str, object]:
        """Return the JSON document of the centre in its parent, whose markers are in the same frame."""
        points = zip(markers.template.markers, markers.template.points_m.tolist(), strict=True)
        return {
            "segment": self.parent,
            "method": self.method,
            "position_m": self.in_parent_m.tolist(),
            "std_mm": _millimetres(self.std_m),
            "apart_mm": _millimetres(self.apart_m),
            "attenuation_mm": _millimetres(float(np.linalg.norm(self.attenuation_m[:3]))),
            "markers_m": {name: place for name, place in points if np.isfinite(place).all()},
        }


def functional_centre(
    joint: str, parent: SegmentMotion, child: SegmentMotion, *, weighted: bool = False
) -> FunctionalCentre:
    """Find the centre of a joint by SCoRE.

    Parameters
    ----------
    joint : str
        Such as ``hip_left``; a known name makes the advice concrete.
    parent, child : SegmentMotion
        Of the same trials.
    weighted : bool
        Weight frames and segments by how well their markers, if they wander independently, know the centre.

    Raises
    ------
    NotIdentifiable
        If no frame shows both segments, or nothing turned.
    """
    motion = joint_motion(joint, parent, child)
    plain = part_sums(motion, motion.parts.part)
    turned = turning(plain.gram.sum(axis=0))
    unobservable = turned.turned_rad < least_turn_rad(parent, child)
    if unobservable.all():
        raise NotIdentifiable(nothing_turned(joint, turned, parent, child, motion_for_centre(joint)))
    basis = revealed_basis(turned, unobservable)
    attenuation = _attenuation(motion, basis)
    everything = np.ones(motion.parts.n_part, dtype=bool)
    both = centre(plain, everything, basis)
    weight = None
    for _ in range(_ITERATIONS if weighted else 0):
        weight = _weights(parent, child, motion, both)
        both = centre(part_sums(motion, motion.parts.part, weight), everything, basis)
    sums = part_sums(motion, motion.parts.part, weight)
    moved = moved_trials(motion, int(unobservable.sum()))
    trials = part_sums(motion, motion.parts.trial, weight)
    gap = np.einsum("nij,j->ni", np.concatenate([motion.R, -motion.S], axis=2), both) - (motion.q - motion.p)
    return FunctionalCentre(
        joint,
        parent.name,
        child.name,
        "weighted score" if weighted else "score",
        both[:3],
        both[3:],
        jackknife(lambda use: centre(sums, use, basis), motion.parts.n_part) + np.outer(attenuation, attenuation),
        attenuation,
        motion.parts.n_part,
        rms_apart([centre(trials, use, basis)[:3] for use in moved]),
        float(np.sqrt(np.mean(np.sum(gap**2, axis=1)))),
        turned,
        unobservable,
        _centre_notes(joint, parent, turned, unobservable)
        + trial_notes(joint, parent, moved)
        + parent.notes
        + child.notes,
    )


def _attenuation(motion: RelativeMotion, basis: Floats) -> Floats:
    """Return how far the centre would move without the attenuation by turns of the skin, (6,) [m]."""
    plain = both = without_attenuation(motion, (0.0, 0.0), basis)
    for _ in range(_ITERATIONS):
        both = without_attenuation(motion, skin_turns(motion, both), basis)
    return both - plain


def _weights(parent: SegmentMotion, child: SegmentMotion, motion: RelativeMotion, both: Floats) -> Floats:
    """Return the inverse covariance of the difference of both centres, in the world, (n, 3, 3) [1/m²]."""
    total = np.zeros((motion.n_frame, 3, 3))
    for segment, at, R in ((parent, both[:3], motion.R), (child, both[3:], motion.S)):
        own = pose_covariance(segment.template.points_m, segment.whole, at, segment.variance_m2)[motion.used]
        total += R @ own @ R.transpose(0, 2, 1)
    return np.asarray(np.linalg.inv(total))


def _centre_notes(
    joint: str, parent: SegmentMotion, turned: Turning, unobservable: NDArray[np.bool_]
) -> tuple[Note, ...]:
    if not unobservable.any():
        return ()
    towards = " and ".join(_along(direction, parent) for direction in turned.in_parent[unobservable])
    how = ", ".join(f"{np.degrees(x):.1f}°" for x in turned.turned_rad[unobservable])
    text = (
        f"the motion does not reveal where the centre of {joint} lies along {towards}, which turned by {how} rms "
        f"only; it is left halfway between the markers of both segments; to reveal it, {motion_for_centre(joint)}"
    )
    return (Note("hinge", text),)


def _along(direction: Floats, parent: SegmentMotion) -> str:
    """Name a direction in a segment by the two of its markers that lie along it most nearly."""
    points = parent.template.points_m
    first, second = np.triu_indices(len(points), 1)
    apart = points[second] - points[first]
    lengths = np.linalg.norm(apart, axis=1)
    alike = np.abs(apart @ direction) / np.where(lengths > 0.0, lengths, np.inf)
    best = int(np.nanargmax(alike))
    names = parent.template.markers
    return f"the direction {names[first[best]]}–{names[second[best]]} of {parent.name}"


def _millimetres(x: float) -> float | None:
    return 1e3 * x if np.isfinite(x) else None
