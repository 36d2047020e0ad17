"""A whole person from recordings of markers: from files' positions to a fitted tree."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from arm.body.landmarks import LANDMARK_STD_M, landmark_places
from arm.body.limbs import BODY, MEAN_PERSON
from arm.marker_kinematics import Integers
from arm.model import Body, Floats
from fitter.body.body_fit import BodyFit
from fitter.body.body_map import BodyLimbs, body_with_limbs
from fitter.body.derived_body import derived_body
from fitter.body.stance import bent_knees, stance
from fitter.body.start import BodyStart, initial_body
from fitter.functional.disjoint import disjoint_parts
from fitter.functional.marker_set import MarkerSet
from fitter.limb.base_orientation import against_landmarks
from fitter.limb.bundle import Bundle, Prior, Task, fit_bundle
from fitter.limb.disjoint_fits import disjoint_fits
from fitter.limb.floating_base import floating_angles
from fitter.limb.frame_choice import left_out, shares, thinned, usable_frames
from fitter.limb.functional_error import systematic_std_m
from fitter.limb.initial_geometry import PLACE_STD_M
from fitter.limb.inverse_kinematics import follow, link_poses
from fitter.limb.limb_calibration import FIRST_STD_M, left_at_prior
from fitter.limb.limb_trials import LimbTrials, sorted_trials
from fitter.limb.marker_observations import Frames, MarkerModel
from fitter.limb.nan_statistics import nan_median
from fitter.limb.uncertainty import Errors, errors_of
from protocol.markers.recording import MarkerRecording

#: Frames that a fit takes, evenly spread over all that can be used.
FIT_FRAMES = 300
#: How well the stance has a marker of pelvis or thorax in its segment [m]: upright frames have it to millimetres,
#: but people stand with pelvis and trunk inclined by some 5° from each other, and markers are 20 cm away.
_CARRIED_M = 0.02
#: How long a movement such as a squat lasts [s], a convention. In it skin goes with the joints' angles, and alike
#: the next time: one movement has one error of the skin.
_MOVEMENT_S = 3.0


def calibrate_body(
    recordings: Sequence[MarkerRecording],
    marker_set: MarkerSet,
    body: Body | None = None,
    seed: int = 0,
    fit_frames: int = FIT_FRAMES,
    progress: Callable[[str, int], None] | None = None,
) -> BodyFit:
    """Learn a person's geometry, where the markers sit, and how far both may be off.

    Parameters
    ----------
    recordings : sequence of MarkerRecording
        Of one person, some of whose frames show an upright stance.
    marker_set : MarkerSet
    body : Body, optional
        Mass, height and sex, where they are known.
    seed : int
        Of the postures that angles begin from.
    fit_frames : int
        How many frames the fit takes.
    progress : callable, optional
        Called with what is being done, and the iteration.

    Raises
    ------
    DataError
        If the recordings have no marker of pelvis or thorax.
    NotIdentifiable
        If those have no pose, or nothing tells left from right.
    """
    person = replace(MEAN_PERSON, preset=BODY) if body is None else body
    arm, where = body_with_limbs(person)
    trials = sorted_trials(recordings, marker_set, tuple(where.links), ("pelvis", "thorax"))
    stand = stance(trials)
    begin = initial_body(arm, where, trials, stand, person.height_m)
    on = [(m, k) for s, k in where.links.items() for m in trials.segments.get(s, ()) if m not in trials.computed]
    names, links = tuple(m for m, _ in on), np.array([k for _, k in on], dtype=np.int64)
    y = np.stack([trials.of(name) for name in names], axis=1)
    n = len(y)
    frames, usable = usable_frames(y, np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3)), recordings)
    rows = thinned(usable, fit_frames)
    chosen = frames.rows(thinned(np.ones(len(frames.t), dtype=bool), fit_frames))
    q = _first_angles(begin, chosen, rows, seed)
    place = _placed(begin, links, chosen, q)
    there = np.asarray(np.isfinite(place).all(axis=1))
    names = tuple(name for name, ok in zip(names, there.tolist(), strict=True) if ok)
    chosen = chosen._replace(y=np.ascontiguousarray(chosen.y[:, there]))
    markers = MarkerModel(names, links[there], place[there], np.full(len(names), FIRST_STD_M), 0)
    task, n_part, trial = _task(where, trials, begin, markers, chosen, person.height_m)
    q = follow(markers.chain(begin.geometry), chosen, markers.std, begin.angles, seed, q, q)
    report = None if progress is None else lambda iteration: progress("fitting", iteration)
    bundle = fit_bundle(task, begin.geometry, markers, q, report)
    halves = disjoint_fits(task, bundle, trial, progress)
    found = _errors(where, task, bundle, n_part, halves)
    knees = [limb.first + limb.where.centres["knee"] for limb in where.limbs if limb.is_leg]
    bent = bent_knees(bundle.q[stand.rows[rows]][:, knees])
    notes = (
        *trials.notes,
        *left_out(usable, recordings),
        *against_landmarks(trials),
        *stand.notes,
        *bent,
        *begin.notes,
        *left_at_prior(task, found),
    )
    return BodyFit(arm, where, trials, begin, task, rows, bundle, found, tuple(dict.fromkeys(notes)))


def _first_angles(begin: BodyStart, frames: Frames, rows: Integers, seed: int) -> Floats:
    """Return the angles that bring centres and landmarks nearest, (n_frame, n_joint)."""
    virtual = frames._replace(y=np.ascontiguousarray(begin.points[rows]))
    about = floating_angles(begin.geometry, begin.virtual, virtual, begin.angles, seed)
    chain = begin.virtual.chain(begin.geometry)
    return follow(chain, virtual, begin.virtual.std, begin.angles, seed, begin=about)


def _placed(begin: BodyStart, links: Integers, frames: Frames, q: Floats) -> Floats:
    """Return where markers are in their links in the median of the frames, (m, 3) [m]."""
    R, o = link_poses(begin.virtual.chain(begin.geometry), frames, q)
    return np.array(
        [nan_median(np.einsum("nji,nj->ni", R[:, k], frames.y[:, m] - o[:, k])) for m, k in enumerate(links)]
    )


def _task(
    where: BodyLimbs, trials: LimbTrials, begin: BodyStart, markers: MarkerModel, frames: Frames, height_m: float
) -> tuple[Task, int, Integers]:
    place, std = markers.place.copy(), np.full(len(markers.names), PLACE_STD_M)
    for m, name in enumerate(markers.names):
        if name in begin.virtual.names:  # a marker of pelvis or thorax
            place[m], std[m] = begin.virtual.place[begin.virtual.names.index(name)], _CARRIED_M
    for limb in where.limbs:
        about = landmark_places(begin.limbs[limb.name], limb.where, height_m)
        for landmark, marker in trials.landmarks.items():
            if marker in markers.names and landmark in about and about[landmark][0] >= 0:
                m = markers.names.index(marker)
                place[m], std[m] = about[landmark][1], LANDMARK_STD_M
    information = np.concatenate([begin.free.std**-2, np.repeat(std**-2, 3)])
    n_trial = int(frames.trial.max()) + 1
    parts = disjoint_parts([np.ones(int((frames.trial == i).sum()), dtype=bool) for i in range(n_trial)])
    task = Task(
        begin.free, frames, shares(frames, _MOVEMENT_S), np.maximum(parts.part, 0).astype(np.int64),
        Prior(begin.geometry, place, information), begin.angles,
    )  # fmt: skip
    return task, parts.n_part, parts.trial.astype(np.int64)


def _errors(where: BodyLimbs, task: Task, bundle: Bundle, n_part: int, halves: Sequence[Bundle]) -> Errors:
    """Return the errors, with what hips are found to be off by in images, alike in all parts."""
    markers, free = bundle.markers, task.free.names
    found = errors_of(task, bundle, n_part, halves, lambda g, place: derived_body(where, g, markers, place))
    own = derived_body(where, bundle.geometry, markers, markers.place)
    lengths, centres = list(own.lengths), list(own.centres)
    for limb in where.limbs:
        off, k, side = systematic_std_m(limb.begins), limb.first, limb.where.side
        if not off:  # an arm's first joint is of the girdle
            continue
        near = [*(f"parent_position{k + 1}_{axis}" for axis in "xyz"), f"d{k + 3}"]
        at = len(lengths) + 3 * centres.index(f"{limb.begins}_{side}")
        numbers = [lengths.index(f"thigh_{side}"), at, at + 1, at + 2]
        found = found.with_systematic(off, [free.index(name) for name in near], numbers)
    return found
