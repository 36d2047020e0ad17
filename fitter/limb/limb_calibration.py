"""A person's arm or leg from recordings of markers: from files' positions to a fitted chain."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from arm.body.landmarks import LANDMARK_STD_M, LimbMap, landmark_places, limb_map
from arm.body.limbs import MEAN_PERSON, Girdle, limb
from arm.kinematics import axis_frames
from arm.marker_kinematics import Integers
from arm.model import Arm, Body
from fitter.functional.disjoint import coverage_factor, disjoint_parts
from fitter.functional.marker_set import MarkerSet
from fitter.limb.base_motion import base_motion, require_standing
from fitter.limb.base_orientation import away_from_lock, base_orientation
from fitter.limb.bundle import Prior, Task, fit_bundle
from fitter.limb.centres import joint_centres
from fitter.limb.disjoint_fits import disjoint_fits
from fitter.limb.frame_choice import left_out, shares, thinned, usable_frames
from fitter.limb.free_geometry import free_geometry
from fitter.limb.functional_error import beyond_the_acromion
from fitter.limb.initial_geometry import PLACE_STD_M, Start, first_angles, initial_geometry, placed
from fitter.limb.inverse_kinematics import follow, link_poses
from fitter.limb.limb_fit import LimbFit
from fitter.limb.limb_search import Clock, Found, Search, polished, search_limb
from fitter.limb.limb_trials import LimbTrials, limb_trials
from fitter.limb.marker_observations import SWAY, Frames, MarkerModel
from fitter.limb.search_comparison import Comparison, comparison
from fitter.limb.second_start import begun_again
from fitter.limb.uncertainty import Errors, errors
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording

#: Frames that a fit takes, evenly spread over all that can be used.
FIT_FRAMES = 500
#: Where each marker's scale begins [m].
FIRST_STD_M = 0.01


def calibrate(
    recordings: Sequence[MarkerRecording],
    marker_set: MarkerSet,
    preset: str,
    girdle: Girdle = "scapula",
    body: Body | None = None,
    seed: int = 0,
    fit_frames: int = FIT_FRAMES,
    progress: Callable[[str, int], None] | None = None,
    search: Search | None = None,
    clock: Clock = time.process_time,
) -> LimbFit:
    """Learn a limb's geometry, where its markers sit, and how far both may be off.

    Parameters
    ----------
    recordings : sequence of MarkerRecording
        Of one person.
    marker_set : MarkerSet
    preset : str
        One of `arm.body.limbs.LIMBS`.
    girdle : {"scapula", "thorax"}
        From where on an arm begins.
    body : Body, optional
        Mass, height and sex, where they are known.
    seed : int
        Of the postures that angles begin from, and of the search.
    fit_frames : int
        How many frames the fit takes.
    progress : callable, optional
        Called with what is being done, and the iteration.
    search : Search, optional
        Take the answer of the genetic algorithm on the same frames and objective, and compare it with the bundle
        fit's. Without it: the bundle fit's.
    clock : callable
        Processor time [s], for the comparison.

    Raises
    ------
    DataError
        If the recordings have no marker of the limb.
    NotIdentifiable
        If no frame shows base and limb together.
    """
    began = clock()
    person = replace(MEAN_PERSON, preset=preset) if body is None else body
    arm = limb(person, girdle)
    where = limb_map(preset, arm.n_joint)
    trials = limb_trials(recordings, marker_set, where)
    base = base_motion(trials, where.base)
    first = next(s for s in where.parts if s.startswith(("upper_arm", "thigh")))
    reach = sum(abs(joint.a_m) + abs(joint.d_m) for joint in arm.joints[: where.balls[0] + 3])
    require_standing(trials, base, where.base, first, reach)
    axes, base_notes = base_orientation(trials, base, where.side)
    centres, functional, centre_notes = joint_centres(trials, where)
    begin = initial_geometry(arm, where, trials, base, axes, centres, person.height_m)
    names, links = _chain_markers(trials, where)
    y = np.stack([trials.of(name) for name in names], axis=1)
    frames, usable = usable_frames(y, base.R, base.p, recordings)
    rows = thinned(usable, fit_frames)
    chosen = frames.rows(thinned(np.ones(len(frames.t), dtype=bool), fit_frames))
    begin, lock_notes = _clear_of_lock(begin, arm, where, chosen, rows, seed)
    q = first_angles(begin, chosen, rows, seed)
    place = placed(begin, names, links, chosen, q)
    there = np.asarray(np.isfinite(place).all(axis=1))
    names = tuple(name for name, ok in zip(names, there.tolist(), strict=True) if ok)
    chosen = chosen._replace(y=np.ascontiguousarray(chosen.y[:, there]))
    markers = MarkerModel(names, links[there], place[there], np.full(len(names), FIRST_STD_M))
    task, n_part, trial = _task(arm, where, trials, begin, markers, chosen, person.height_m)
    q = follow(markers.chain(begin.geometry), chosen, markers.std, begin.angles, seed, q)
    report = _reporter(progress, "fitting")
    bundle = begun_again(task, fit_bundle(task, begin.geometry, markers, q, report), seed, report)
    rivals = None
    if search is not None:
        plain = Found(bundle, clock() - began, len(rows))
        rivals = _searched(where, task, markers, seed, search, plain, progress, clock)
        bundle = rivals.found["ga"].bundle
    halves = disjoint_fits(task, bundle, trial, progress)
    found = errors(where, task, bundle, n_part, halves)
    notes = (*trials.notes, *left_out(usable, recordings), *base.notes, *base_notes, *centre_notes, *lock_notes)
    notes = (*notes, *left_at_prior(task, found))
    notes = notes if rivals is None else (*notes, *rivals.notes())
    acromion = marker_set.landmarks.get(f"acromion_{where.side}")
    if acromion is not None and not where.balls[0] and "elbow" in where.centres:
        seen = np.concatenate([r.of([acromion])[:, 0] for r in recordings])[rows]
        k = task.free.names.index("d3")
        least = abs(bundle.geometry.numbers[2, 2]) - coverage_factor(n_part) * found.free_std[k]
        said = beyond_the_acromion(where, chosen, bundle.markers.chain(bundle.geometry), bundle.q, seen, least)
        notes = (*notes, said) if said else notes
    return LimbFit(
        arm, where, trials, base, task, rows, bundle, tuple(functional), found, tuple(dict.fromkeys(notes)), rivals
    )


def _reporter(progress: Callable[[str, int], None] | None, what: str) -> Callable[[int], None] | None:
    return None if progress is None else lambda iteration: progress(what, iteration)


def _searched(
    where: LimbMap,
    task: Task,
    markers: MarkerModel,
    seed: int,
    search: Search,
    bundle: Found,
    progress: Callable[[str, int], None] | None,
    clock: Clock,
) -> Comparison:
    """Return the genetic algorithm's answer, by itself and polished, beside the bundle fit's."""
    found = search_limb(task, markers, seed, search, _reporter(progress, "searching"), clock)
    return comparison(where, task, {"bundle": bundle, "ga": found, "ga+bundle": polished(task, found, clock)})


def _chain_markers(trials: LimbTrials, where: LimbMap) -> tuple[tuple[str, ...], Integers]:
    on = [
        (m, part.link)
        for segment, part in where.parts.items()
        for m in trials.segments.get(segment, ())
        if m not in trials.computed
    ]
    return tuple(m for m, _ in on), np.array([link for _, link in on], dtype=np.int64)


def _clear_of_lock(
    begin: Start, arm: Arm, where: LimbMap, frames: Frames, rows: Integers, seed: int
) -> tuple[Start, tuple[Note, ...]]:
    """Turn frame 0 where the motion comes near gimbal lock of the ball joint behind it."""
    if where.balls[0]:
        return begin, ()
    q = first_angles(begin, frames, rows, seed)
    _, o = link_poses(begin.virtual.chain(begin.geometry), frames, q)
    far = o[:, SWAY + 2] - o[:, SWAY]
    long_axis = np.einsum("nji,nj->ni", frames.R, far / np.linalg.norm(far, axis=1, keepdims=True))
    lateral = begin.geometry.base_R @ axis_frames(arm, np.zeros(arm.n_joint))[0, 0, :3, 2]
    better = away_from_lock(long_axis, lateral)
    if better is None:
        return begin, ()
    turn, _ = Rotation.align_vectors(better[None], lateral[None])
    degrees = float(np.degrees(np.arccos(np.clip(better @ lateral, -1.0, 1.0))))
    text = (
        f"the motion comes near the posture in which two axes of the {next(iter(where.centres))} fall together: "
        f"frame 0 is turned by {degrees:.0f}° from forward, left and up, so its angles are not the anatomical ones"
    )
    turned = replace(begin.geometry, base_R=turn.as_matrix() @ begin.geometry.base_R)
    return replace(begin, geometry=turned), (Note("gimbal_lock", text),)


def _task(
    arm: Arm,
    where: LimbMap,
    trials: LimbTrials,
    begin: Start,
    markers: MarkerModel,
    frames: Frames,
    height_m: float,
) -> tuple[Task, int, Integers]:
    free = free_geometry(arm, begin.centre_std_m, begin.length_std_m)
    place, std = markers.place.copy(), np.full(len(markers.names), PLACE_STD_M)
    about = landmark_places(arm, where, height_m)
    for landmark, marker in trials.landmarks.items():
        if marker in markers.names and landmark in about and about[landmark][0] >= 0:
            m = markers.names.index(marker)
            place[m], std[m] = about[landmark][1], LANDMARK_STD_M
    information = np.concatenate([free.std**-2, np.repeat(std**-2, 3)])
    n_trial = int(frames.trial.max()) + 1
    parts = disjoint_parts([np.ones(int((frames.trial == i).sum()), dtype=bool) for i in range(n_trial)])
    task = Task(
        free, frames, shares(frames), np.maximum(parts.part, 0).astype(np.int64),
        Prior(begin.geometry, place, information), begin.angles,
    )  # fmt: skip
    return task, parts.n_part, parts.trial.astype(np.int64)


def left_at_prior(task: Task, found: Errors) -> list[Note]:
    """Say which free numbers the motion did not determine."""
    unresolved = [name for name, learnt in zip(task.free.names, found.learnt, strict=True) if not learnt]
    if not unresolved:
        return []
    text = (
        f"the motion tells little of {', '.join(unresolved)}: left near the prior, which is the table's or a "
        "landmark's"
    )
    return [Note("left_at_prior", text, columns=tuple(unresolved))]
