"""A joint's axis from functional trials, with its error and with what the motion does not determine.

The error comes from disjoint trials or parts of trials, as that of a centre does (`functional_centre`).
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.functional.advice import motion_for_axis
from fitter.functional.disjoint import coverage_factor, jackknife, rms_apart
from fitter.functional.relative_motion import Turning, part_sums, turning
from fitter.functional.sara import axis
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

#: A turn about an axis is a hinge's where it is this much larger, rms, than that about the next: the direction
#: is then decided by the hinge and not by the rest.
_SINGLE_AXIS = 2.0


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
    motion = joint_motion(joint, parent, child)
    sums = part_sums(motion, motion.parts.part)
    turned = turning(sums.gram.sum(axis=0))
    if turned.turned_rad[1] < least_turn_rad(parent, child):
        raise NotIdentifiable(nothing_turned(joint, turned, parent, child, motion_for_axis(joint)))
    everything = np.ones(motion.parts.n_part, dtype=bool)
    both = axis(sums, everything)
    along = np.array([True, False, False])
    point = centre(sums, everything, revealed_basis(turned, along))
    trials = part_sums(motion, motion.parts.trial)
    moved = moved_trials(motion, 1)
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
        rms_apart([axis(trials, use, both)[:3] for use in moved]),
        float(np.sqrt(np.mean(np.sum(gap**2, axis=1)))),
        turned,
        _axis_notes(joint, turned) + trial_notes(joint, parent, moved) + parent.notes + child.notes,
    )


def _axis_notes(joint: str, turned: Turning) -> tuple[Note, ...]:
    about = turned.about_rad
    if about[0] >= _SINGLE_AXIS * about[1]:
        return ()
    text = (
        f"{joint} turned by {np.degrees(about[0]):.0f}° rms about one axis and by {np.degrees(about[1]):.0f}° "
        f"about another, so that it has no single axis in this motion; to reveal one, {motion_for_axis(joint)}"
    )
    return (Note("no_single_axis", text),)


def _degrees(x: float) -> float | None:
    return float(np.degrees(x)) if np.isfinite(x) else None
