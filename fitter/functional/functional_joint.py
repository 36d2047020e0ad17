"""A joint's centre and axis from functional trials, each with its error and with what the motion left open.

The errors come from disjoint trials or parts of trials (`disjoint`). They tell how far the answer would move with
another motion of the same kind, and nothing of what skin does alike in all of them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.functional.advice import motion_for_axis, motion_for_centre
from fitter.functional.disjoint import coverage_factor, jackknife, rms_apart
from fitter.functional.pose_error import pose_covariance
from fitter.functional.relative_motion import PartSums, RelativeMotion, Turning, part_sums, relative_motion, turning
from fitter.functional.sara import axis
from fitter.functional.score import centre, revealed_basis
from fitter.functional.segment_motion import SegmentMotion
from limbcal.errors import NotIdentifiable
from limbcal.note import Note

#: Turn, rms, that a centre's place or an axis needs to be called revealed [rad]: 8°, a swing of 11° to each side.
#: Skin turns a cluster by 3° rms about the bone (Benoit et al. 2006), and (3/8)² = 14 % is how far such noise in the
#: regressor draws a centre towards the markers.
LEAST_TURN_RAD = np.radians(8.0)
#: The same for noise as large as the residuals of the markers show it: (1/3)² = 11 %.
_LEAST_TURN_IN_NOISE = 3.0
#: A turn about an axis is a hinge's where it is this much larger, rms, than that about the next: the direction is then
#: decided by the hinge and not by the rest.
_SINGLE_AXIS = 2.0
_ITERATIONS = 3  # of the weights, which depend on the centre: the second moves it by tenths of a millimetre


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
        Of both, from disjoint parts; NaN where there are fewer than two.
    n_part : int
        Parts behind it: ``coverage_factor(n_part)`` standard deviations make the 95 % interval.
    apart_m : float
        How far disjoint trials (halves of the only one) disagree on the place in the parent, rms.
    rms_m : float
        How far the two segments' centres are from each other, rms over the frames.
    turning : Turning
        What turned; ``turning.in_parent[k]`` is a direction in the parent.
    unseen : (3,) bool
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
    n_part: int
    apart_m: float
    rms_m: float
    turning: Turning
    unseen: NDArray[np.bool_]
    notes: tuple[Note, ...]

    @property
    def std_m(self) -> float:
        """Root mean square length of the error of the place in the parent [m]."""
        return float(np.sqrt(np.trace(self.covariance_m2[:3, :3])))

    @property
    def half_width_m(self) -> Floats:
        """Half-widths of the 95 % intervals of the place in the parent, (3,) [m]; infinite where it is not revealed."""
        half = coverage_factor(self.n_part) * np.sqrt(np.diag(self.covariance_m2[:3, :3]))
        along = np.abs(self.turning.in_parent[self.unseen]).max(axis=0, initial=0.0) > 1e-6
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
            "markers_m": {name: place for name, place in points if np.isfinite(place).all()},
        }


@dataclass(frozen=True)
class FunctionalAxis:
    """The axis of a joint.

    Attributes
    ----------
    joint, parent, child : str
    in_parent, in_child : (3,)
        Unit directions.
    point_in_parent_m, point_in_child_m : (3,)
        A point of the axis, halfway along it between the segments' origins.
    covariance : (6, 6)
        Of both directions, from disjoint parts [rad²].
    n_part : int
    apart_rad : float
        How far disjoint trials (halves of the only one) disagree on the direction in the parent, rms.
    rms_rad : float
        How far the two segments' directions are from each other, rms over the frames.
    turning : Turning
    notes : tuple of Note
    """

    joint: str
    parent: str
    child: str
    in_parent: Floats
    in_child: Floats
    point_in_parent_m: Floats
    point_in_child_m: Floats
    covariance: Floats
    n_part: int
    apart_rad: float
    rms_rad: float
    turning: Turning
    notes: tuple[Note, ...]

    @property
    def std_rad(self) -> float:
        """Root mean square angle of the error of the direction in the parent [rad]."""
        return float(np.sqrt(np.trace(self.covariance[:3, :3])))

    @property
    def half_width_rad(self) -> float:
        """Angle that holds the direction in the parent with 95 % [rad]."""
        return coverage_factor(self.n_part) * self.std_rad

    def document(self) -> dict[str, object]:
        """Return the JSON document of the axis in its parent."""
        return {
            "segment": self.parent,
            "direction": self.in_parent.tolist(),
            "point_m": self.point_in_parent_m.tolist(),
            "std_deg": _degrees(self.std_rad),
            "apart_deg": _degrees(self.apart_rad),
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
    motion = _motion(joint, parent, child)
    plain = part_sums(motion, motion.parts.part)
    turned = turning(plain.gram.sum(axis=0))
    unseen = turned.turned_rad < least_turn_rad(parent, child)
    if unseen.all():
        raise NotIdentifiable(_nothing_turned(joint, turned, parent, child, motion_for_centre(joint)))
    basis = revealed_basis(turned, unseen)
    everything = np.ones(motion.parts.n_part, dtype=bool)
    both = centre(plain, everything, basis)
    weight = None
    for _ in range(_ITERATIONS if weighted else 0):
        weight = _weights(parent, child, motion, both)
        both = centre(part_sums(motion, motion.parts.part, weight), everything, basis)
    sums = part_sums(motion, motion.parts.part, weight)
    trials = part_sums(motion, motion.parts.trial, weight)
    gap = np.einsum("nij,j->ni", np.concatenate([motion.R, -motion.S], axis=2), both) - (motion.q - motion.p)
    return FunctionalCentre(
        joint,
        parent.name,
        child.name,
        "weighted score" if weighted else "score",
        both[:3],
        both[3:],
        jackknife(lambda use: centre(sums, use, basis), motion.parts.n_part),
        motion.parts.n_part,
        rms_apart([centre(trials, use, basis)[:3] for use in _moved(motion, unseen)]),
        float(np.sqrt(np.mean(np.sum(gap**2, axis=1)))),
        turned,
        unseen,
        _centre_notes(joint, parent, turned, unseen),
    )


def functional_axis(joint: str, parent: SegmentMotion, child: SegmentMotion) -> FunctionalAxis:
    """Find the axis of a joint by SARA.

    Parameters
    ----------
    joint : str
        Such as ``knee_right``.
    parent, child : SegmentMotion
        Of the same trials.

    Raises
    ------
    NotIdentifiable
        If no frame shows both segments, or nothing turned.
    """
    motion = _motion(joint, parent, child)
    sums = part_sums(motion, motion.parts.part)
    turned = turning(sums.gram.sum(axis=0))
    if turned.turned_rad[1] < least_turn_rad(parent, child):
        raise NotIdentifiable(_nothing_turned(joint, turned, parent, child, motion_for_axis(joint)))
    everything = np.ones(motion.parts.n_part, dtype=bool)
    both = axis(sums, everything)
    along = np.array([True, False, False])
    point = centre(sums, everything, revealed_basis(turned, along))
    trials = part_sums(motion, motion.parts.trial)
    gap = np.einsum("nij,j->ni", motion.R, both[:3]) - np.einsum("nij,j->ni", motion.S, both[3:])
    return FunctionalAxis(
        joint,
        parent.name,
        child.name,
        both[:3],
        both[3:],
        point[:3],
        point[3:],
        jackknife(lambda use: axis(sums, use, both), motion.parts.n_part),
        motion.parts.n_part,
        rms_apart([axis(trials, use, both)[:3] for use in _moved(motion, along)]),
        float(np.sqrt(np.mean(np.sum(gap**2, axis=1)))),
        turned,
        _axis_notes(joint, turned),
    )


def least_turn_rad(parent: SegmentMotion, child: SegmentMotion) -> float:
    """Return the turn, rms, that is needed between two segments, as noisy as their markers show them [rad]."""
    noise = np.sqrt(parent.turn_variance_rad2 + child.turn_variance_rad2)
    return max(float(LEAST_TURN_RAD), _LEAST_TURN_IN_NOISE * float(noise))


def _motion(joint: str, parent: SegmentMotion, child: SegmentMotion) -> RelativeMotion:
    motion = relative_motion(parent.trials, child.trials)
    if not motion.n_frame:
        seen = f"{int(parent.whole.valid.sum())} and {int(child.whole.valid.sum())} frames have a pose, none together"
        raise NotIdentifiable(f"{joint}: of {parent.name} and {child.name} {seen}, expected frames that show both")
    return motion


def _weights(parent: SegmentMotion, child: SegmentMotion, motion: RelativeMotion, both: Floats) -> Floats:
    """Return the inverse covariance of the difference of both centres, in the world, (n, 3, 3) [1/m²]."""
    total = np.zeros((motion.n_frame, 3, 3))
    for segment, at, R in ((parent, both[:3], motion.R), (child, both[3:], motion.S)):
        own = pose_covariance(segment.template.points_m, segment.whole, at, segment.variance_m2)[motion.used]
        total += R @ own @ R.transpose(0, 2, 1)
    return np.asarray(np.linalg.inv(total))


def _moved(motion: RelativeMotion, unseen: NDArray[np.bool_]) -> list[NDArray[np.bool_]]:
    """Return each trial by itself that turned enough to tell what all together tell."""
    grams = part_sums(motion, motion.parts.trial).gram
    enough = [bool(np.all((turning(g).turned_rad >= LEAST_TURN_RAD)[np.sort(unseen)[::-1] == 0])) for g in grams]
    return [np.arange(len(grams)) == i for i in range(len(grams)) if enough[i]]


def _nothing_turned(
    joint: str, turned: Turning, parent: SegmentMotion, child: SegmentMotion, motion: str
) -> str:
    seen = f"{np.degrees(turned.turned_rad[2]):.1f}° rms"
    need = f"{np.degrees(least_turn_rad(parent, child)):.0f}°"
    return f"{joint}: {child.name} turned by {seen} relative to {parent.name}, expected at least {need}: {motion}"


def _centre_notes(
    joint: str, parent: SegmentMotion, turned: Turning, unseen: NDArray[np.bool_]
) -> tuple[Note, ...]:
    if not unseen.any():
        return ()
    towards = " and ".join(_along(direction, parent) for direction in turned.in_parent[unseen])
    how = ", ".join(f"{np.degrees(x):.1f}°" for x in turned.turned_rad[unseen])
    text = (
        f"the motion does not reveal where the centre of {joint} lies along {towards}, which turned by {how} rms only; "
        f"it is left halfway between the markers of both segments; to reveal it, {motion_for_centre(joint)}"
    )
    return (Note("hinge", text),)


def _axis_notes(joint: str, turned: Turning) -> tuple[Note, ...]:
    about = turned.about_rad
    if about[0] >= _SINGLE_AXIS * about[1]:
        return ()
    text = (
        f"{joint} turned by {np.degrees(about[0]):.0f}° rms about one axis and by {np.degrees(about[1]):.0f}° about "
        f"another, so that it has no single axis in this motion; to reveal one, {motion_for_axis(joint)}"
    )
    return (Note("no_single_axis", text),)


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


def _degrees(x: float) -> float | None:
    return float(np.degrees(x)) if np.isfinite(x) else None
