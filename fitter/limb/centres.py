"""Where the joints' centres are in the segments, before the bundle fit: by motion, else by landmarks.

The hip by regression from the pelvis; elbow, wrist, knee and ankle by the middle of their landmarks: what is known
of them before anything moves. Else, as the shoulder, by SCoRE where the motion reveals them, which on a hinge is
the point of its axis halfway between the two segments. The bundle fit sees the same motion again, so that a centre
by SCoRE is hardly more than a place to begin.
"""

from dataclasses import dataclass, field

import numpy as np

from arm.body.landmarks import LimbMap
from arm.model import Floats
from fitter.functional.functional_centre import FunctionalCentre, functional_centre
from fitter.functional.regression_centre import regression_centres
from fitter.limb.base_orientation import seen_or_posed
from fitter.limb.limb_trials import LimbTrials
from fitter.limb.nan_statistics import nan_median
from limbcal.errors import NotIdentifiable
from limbcal.note import Note

#: How well a centre in the middle of its landmarks is known before the bundle fit, and one by SCoRE, along an axis
#: [m]; assumed.
_MIDDLE_M, _SCORE_M = 0.05, 0.02
#: Landmarks on either side of a centre.
_MIDDLE = {
    "elbow": ("lateral_epicondyle", "medial_epicondyle"),
    "wrist": ("radial_styloid", "ulnar_styloid"),
    "knee": ("lateral_femoral_epicondyle", "medial_femoral_epicondyle"),
    "ankle": ("lateral_malleolus", "medial_malleolus"),
}


@dataclass(frozen=True)
class Centre:
    """A joint's centre.

    Attributes
    ----------
    method : str
        ``score``, ``landmarks`` or the name of a regression.
    std_m : float
        How well it is known before the bundle fit, along an axis [m].
    world_m : mapping of str to (n_frame, 3)
        Where each segment that has it carries it, in all frames; NaN where the segment has no pose.
    in_segment_m : mapping of str to (3,)
        The same in the segments' own frames.
    """

    method: str
    std_m: float
    world_m: dict[str, Floats] = field(default_factory=dict)
    in_segment_m: dict[str, Floats] = field(default_factory=dict)


def joint_centres(
    trials: LimbTrials, where: LimbMap
) -> tuple[dict[str, Centre], list[FunctionalCentre], list[Note]]:
    """Return what is known of the limb's centres, functional ones included, and what the motion leaves open."""
    centres, functional, notes = dict[str, Centre](), list[FunctionalCentre](), list[Note]()
    chain = [s for s in where.parts if not s.startswith("scapula")]
    parents = [where.base, *chain[:-1]]
    for parent, child in zip(parents, chain, strict=True):
        name = where.parts[child].begins
        joint = f"{name}_{where.side}"
        found: FunctionalCentre | None = None
        if parent in trials.motions and child in trials.motions:
            try:
                found = functional_centre(joint, trials.motions[parent], trials.motions[child])
                functional.append(found)
                notes += [note for note in found.notes if note.kind != "doubted_pose"]
            except NotIdentifiable as error:
                notes.append(Note("not_revealed", str(error)))
        known = _by_regression(trials, where) if name == "hip" else _by_landmarks(trials, where, name, parent)
        centre = known or _by_motion(trials, found)
        if centre is not None:
            centres[name] = _carried_by_both(trials, centre, (parent, child))
    return centres, functional, notes


def _by_motion(trials: LimbTrials, found: FunctionalCentre | None) -> Centre | None:
    if found is None or (found.unobservable.any() and found.joint.startswith(("hip", "shoulder"))):
        return None
    centre = Centre("score", _SCORE_M)
    for segment, place in ((found.parent, found.in_parent_m), (found.child, found.in_child_m)):
        whole = trials.motions[segment].whole
        centre.world_m[segment] = np.einsum("nij,j->ni", whole.R, place) + whole.p
        centre.in_segment_m[segment] = place
    return centre


def _by_landmarks(trials: LimbTrials, where: LimbMap, name: str, segment: str) -> Centre | None:
    marks = [trials.landmarks.get(f"{landmark}_{where.side}") for landmark in _MIDDLE.get(name, ())]
    if not marks or not all(marks):
        return None
    middle = 0.5 * (seen_or_posed(trials, str(marks[0])) + seen_or_posed(trials, str(marks[1])))
    if np.isfinite(middle[:, 0]).sum() < 3:
        return None
    centre = Centre("landmarks", _MIDDLE_M, {segment: middle})
    if segment in trials.motions:
        whole = trials.motions[segment].whole
        centre.in_segment_m[segment] = nan_median(np.einsum("nji,nj->ni", whole.R, middle - whole.p))
    return centre


def _by_regression(trials: LimbTrials, where: LimbMap) -> Centre | None:
    landmarks = {name: seen_or_posed(trials, marker) for name, marker in trials.landmarks.items()}
    joint = f"hip_{where.side}"
    for found in regression_centres(landmarks):
        if found.joint == joint and np.isfinite(found.position_m).any():
            centre = Centre(found.method, found.error_m / np.sqrt(3.0), {where.base: found.position_m})
            if where.base in trials.motions:
                whole = trials.motions[where.base].whole
                local = np.einsum("nji,nj->ni", whole.R, found.position_m - whole.p)
                centre.in_segment_m[where.base] = nan_median(local)
            return centre
    return None


def _carried_by_both(trials: LimbTrials, centre: Centre, segments: tuple[str, str]) -> Centre:
    """Give a centre that one segment carries to the other too, where both are seen together."""
    for segment in segments:
        if segment in centre.in_segment_m or segment not in trials.motions:
            continue
        world = next(iter(centre.world_m.values()))
        whole = trials.motions[segment].whole
        local = np.einsum("nji,nj->ni", whole.R, world - whole.p)
        if np.isfinite(local[:, 0]).any():
            place = nan_median(local)
            centre.in_segment_m[segment] = place
            centre.world_m[segment] = np.einsum("nij,j->ni", whole.R, place) + whole.p
    return centre
