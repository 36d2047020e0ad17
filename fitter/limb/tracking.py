"""Markers of recordings to joint motion of a calibrated arm, and to that of the segment that carries its base."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from arm.base_pose import base_in_segment
from arm.body.landmarks import limb_map
from arm.body.limbs import BODY, LIMBS
from arm.body.whole_body import body_map
from arm.effects.marker_effects import marked_in, slid_markers
from arm.marker_kinematics import MarkerChain
from arm.model import Arm, Floats
from fitter.functional.rigid_fit import fit_poses
from fitter.functional.template import doubtful_rms_m
from fitter.limb.base_motion import BaseMotion, poses_of, quaternions
from fitter.limb.floating_base import floating_angles, floating_joints
from fitter.limb.free_geometry import Geometry, geometry_of
from fitter.limb.initial_geometry import joint_prior
from fitter.limb.inverse_kinematics import follow, link_poses, predicted
from fitter.limb.marker_observations import SWAY, AnglePrior, Frames, MarkerModel, base_follows, with_base
from fitter.limb.motion_smoother import Smoothed, smooth
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording

#: How far a marker wanders where the arm file does not say so, and at the least [m].
_USUAL_STD_M, _LEAST_STD_M = 0.008, 0.004
#: Share of a limb's density of the jerk that a body takes: fifty markers see its trunk where five see a limb's
#: joint, so that the same frequencies pass with a tenth.
_JERK_OF_A_BODY = 0.1
#: Least markers of the chain with which a frame determines its angles by itself.
_LEAST_MARKERS = 3
#: Passes in which skin slides with the joints: it slides by centimetres a radian, so each pass leaves a tenth of
#: the error or less.
_PASSES = 3


@dataclass(frozen=True)
class TrackedLimb:
    """The motion of one recording.

    Attributes
    ----------
    t : (n_frame,) [s]
    q, q_std : (n_frame, n_joint) [rad]
    base : (n_frame, 7), or None
        x, y, z [m] and the quaternion w, x, y, z of the segment that carries the base; None where the base floats
        by joints of its own.
    distance_m : (n_frame, n_marker)
        Of every marker of the arm from where the motion has it, NaN where it was not seen.
    notes : tuple of Note
    """

    t: Floats
    q: Floats
    q_std: Floats
    base: Floats | None
    distance_m: Floats
    notes: tuple[Note, ...]


@dataclass(frozen=True)
class MarkedArm:
    """An arm with markers, as tracking takes it apart: the chain, its markers, the base's, and both's."""

    geometry: Geometry
    markers: MarkerModel
    base: BaseMotion
    everything: MarkerModel
    angles: AnglePrior

    @property
    def names(self) -> tuple[str, ...]:
        """All markers, those of the links first."""
        return (*self.markers.names, *self.base.markers)


def marked_arm(arm: Arm) -> MarkedArm:
    """Take an arm apart.

    Raises
    ------
    ConfigError
        If it has no markers on its links, or a joint that slides and is none of a floating base.
    """
    on_links = [m for m in arm.markers if m.joint > 0]
    if not on_links:
        raise ConfigError(
            f"arm {arm.name!r} has no [[marker]] on its links, expected those of `fitter kinematics --body`"
        )
    n_floating = 0 if arm.base is not None and arm.base.segment else floating_joints(arm)
    if any(joint.type != "revolute" for joint in arm.joints[n_floating:]):
        raise ConfigError(
            f"arm {arm.name!r} has a joint that slides, expected only joints that turn, to track markers"
        )
    base_R, base_p = base_in_segment(arm)
    model = MarkerModel(
        tuple(m.name for m in on_links),
        np.array([m.joint - 1 for m in on_links], dtype=np.int64),
        np.array([m.position_m for m in on_links]),
        np.array([max(m.std_m or _USUAL_STD_M, _LEAST_STD_M) for m in on_links]),
        0 if n_floating else SWAY,
    )
    carried = [m for m in arm.markers if m.joint == 0]
    points = np.array([m.position_m for m in carried]).reshape(-1, 3) @ base_R.T + base_p
    segment = None if arm.base is None else arm.base.segment
    base = BaseMotion(segment, tuple(m.name for m in carried), points, np.empty((0, 3, 3)), np.empty((0, 3)))
    angles = joint_prior(arm, _balls(arm), n_floating)
    in_frame_0 = np.array([m.position_m for m in carried]).reshape(-1, 3)
    base_std = max([_LEAST_STD_M, *(m.std_m or _USUAL_STD_M for m in carried)])
    everything = with_base(model, base.markers, in_frame_0, base_std)
    geometry = replace(geometry_of(arm), base_R=base_R, base_p=base_p)
    if not n_floating:
        sway = np.zeros(SWAY)
        with_sway = (np.concatenate([sway, angles.mean]), np.concatenate([sway + 1.0, angles.information]))
        angles = base_follows(AnglePrior(*with_sway), len(carried))
    return MarkedArm(geometry, model, base, everything, angles)


def _balls(arm: Arm) -> tuple[int, ...]:
    if arm.name in LIMBS:
        return limb_map(arm.name, arm.n_joint).balls
    return body_map().balls if arm.name == BODY else ()


def track_limb(
    arm: Arm, recordings: Sequence[MarkerRecording], seed: int = 0, progress: Callable[[int], None] | None = None
) -> list[TrackedLimb]:
    """Track an arm's markers in recordings.

    Parameters
    ----------
    arm : Arm
        With [[marker]] and, where its base is carried, [base].
    recordings : sequence of MarkerRecording
    seed : int
        Of the postures that angles begin from.
    progress : callable, optional
        Told how many recordings are done.

    Raises
    ------
    ConfigError
        If the arm cannot be tracked.
    DataError
        If a recording has too few of the arm's markers.
    """
    marked_arm(arm)
    tracked = []
    for k, recording in enumerate(recordings):
        tracked.append(_track_one(arm, recording, k + 1, seed))
        if progress is not None:
            progress(k + 1)
    return tracked


@dataclass(frozen=True)
class SolvedMotion:
    """The motion of a recording, as the kernels have it.

    Attributes
    ----------
    marked : MarkedArm
        The arm with its markers as they are in that trial.
    chain : MarkerChain
        With the base's sway, where it has one, before the limb's joints.
    frames : Frames
        With the markers that were measured, less by how much skin has slid with them.
    smoothed : Smoothed
    notes : tuple of Note
    """

    marked: MarkedArm
    chain: MarkerChain
    frames: Frames
    smoothed: Smoothed
    notes: tuple[Note, ...]


def solve_motion(arm: Arm, recording: MarkerRecording, trial: int, seed: int = 0) -> SolvedMotion:
    """Return the motion in which the arm's markers come nearest to those of a recording.

    Parameters
    ----------
    arm : Arm
        With its effects; skin that slides with a joint does so with the joint's position of the pass before.
    recording : MarkerRecording
    trial : int
        The recording's number, from 1: effects may act in some trials only.
    seed : int
        Of the postures that angles begin from.

    Raises
    ------
    ConfigError
        If the arm cannot be tracked.
    DataError
        If the recording has too few of the arm's markers.
    """
    here = marked_in(arm, trial)
    marked = marked_arm(here)
    solved = _solved(marked, recording, seed)
    if not slid_markers(here, np.zeros((1, arm.n_joint))):
        return solved
    for _ in range(_PASSES):
        R = link_poses(solved.chain, solved.frames, solved.smoothed.q)[0]
        bare = recording
        for name, slid in slid_markers(here, solved.smoothed.q[:, marked.markers.sway :]).items():
            link = int(solved.chain.link[marked.names.index(name)])
            place = recording.of((name,))[:, 0] - np.einsum("nij,nj->ni", R[:, link], slid)
            bare = bare.with_marker(name, place)
        solved = _solved(marked, bare, seed)
    return solved


def _solved(marked: MarkedArm, recording: MarkerRecording, seed: int) -> SolvedMotion:
    y = recording.of(marked.markers.names)
    seen = np.isfinite(y[..., 0])
    notes = _missing(marked, recording)
    ever = np.asarray(seen.any(axis=0))
    if ever.sum() < _LEAST_MARKERS:
        there = [name for name, ok in zip(marked.markers.names, ever.tolist(), strict=True) if ok]
        raise DataError(
            f"{recording.path}: of {len(marked.markers.names)} markers of the arm it has "
            f"{', '.join(there) or 'none'}, expected at least {_LEAST_MARKERS}"
        )
    carried = recording.of(marked.base.markers)
    R, p, more = _filled(recording, marked, *_trusted(marked.base.points_m, carried))
    t = recording.t
    everything = np.ascontiguousarray(np.concatenate([y, carried], axis=1))
    frames = Frames(everything, R, p, np.zeros(len(t), dtype=np.int64), t)
    chain, std = marked.everything.chain(marked.geometry), marked.everything.std
    sway, about = marked.markers.sway, None
    if not sway:
        about = floating_angles(marked.geometry, marked.everything, frames, marked.angles, seed)
    q = _first(follow(chain, frames, std, marked.angles, seed, begin=about), seen, chain.revolute)
    found = smooth(chain, frames, std, marked.angles, 1.0 / recording.rate_hz, q, 1.0 if sway else _JERK_OF_A_BODY)
    if not found.converged:
        more.append(Note("not_converged", "the angles still change where the search ends: do not rely on them"))
    return SolvedMotion(marked, chain, frames, found, (*notes, *more))


def _track_one(arm: Arm, recording: MarkerRecording, trial: int, seed: int) -> TrackedLimb:
    solved = solve_motion(arm, recording, trial, seed)
    marked, sway, pose = solved.marked, solved.marked.markers.sway, None
    chain, frames, found = solved.chain, solved.frames, solved.smoothed
    distance = np.linalg.norm(frames.y - predicted(chain, frames, found.q), axis=2)
    if sway:
        R0, o0 = (x[:, sway - 1] for x in link_poses(chain, frames, found.q))
        R = R0 @ marked.geometry.base_R.T
        pose = np.hstack([o0 - np.einsum("nij,j->ni", R, marked.geometry.base_p), quaternions(R)])
    return TrackedLimb(frames.t, found.q[:, sway:], found.std[:, sway:], pose, distance, solved.notes)


def _trusted(points_m: Floats, measured_m: Floats) -> tuple[Floats, Floats]:
    """Return the base's poses without those whose markers are far off their shape, where they can be."""
    R, p = poses_of(points_m, measured_m)
    if len(points_m) < 3:
        return R, p
    rms = fit_poses(points_m, measured_m).rms_m
    doubtful = rms > doubtful_rms_m(rms)
    R, p = R.copy(), p.copy()
    R[doubtful], p[doubtful] = np.nan, np.nan
    return R, p


def _first(q: Floats, seen: NDArray[np.bool_], turns: NDArray[np.bool_]) -> Floats:
    """Return angles to begin from: without whole turns, and from frame to frame where too few markers are seen."""
    known = np.flatnonzero(seen.sum(axis=1) >= _LEAST_MARKERS)
    if not len(known):
        return q
    some = np.where(turns, np.unwrap(q[known], axis=0), q[known])
    return np.column_stack([np.interp(np.arange(len(q)), known, column) for column in some.T])


def _missing(marked: MarkedArm, recording: MarkerRecording) -> list[Note]:
    lost = tuple(name for name in marked.names if name not in recording.names)
    if not lost:
        return []
    text = f"{len(lost)} of the arm's {len(marked.names)} markers are not in the recording: {', '.join(lost)}"
    return [Note("missing_marker", text, columns=lost)]


def _filled(
    recording: MarkerRecording, marked: MarkedArm, R: Floats, p: Floats
) -> tuple[Floats, Floats, list[Note]]:
    """Return the base's poses with those in between where its markers were not seen, and say so."""
    known = np.flatnonzero(np.isfinite(p[:, 0]))
    if not len(known):
        raise DataError(
            f"{recording.path}: no frame shows the base's markers {', '.join(marked.base.markers)} together, "
            "expected three of them, or all where there are fewer"
        )
    lost = len(p) - len(known)
    if not lost:
        return np.ascontiguousarray(R), np.ascontiguousarray(p), []
    at = np.clip(np.arange(len(p)), known[0], known[-1])
    p = np.column_stack([np.interp(at, known, p[known, axis]) for axis in range(3)])
    R = (
        Slerp(known, Rotation.from_matrix(R[known]))(at).as_matrix()
        if len(known) > 1
        else R[np.full(len(p), known[0])]
    )
    gaps = np.diff(np.concatenate([[-1], known, [len(p)]])) - 1
    text = (
        f"the base has no pose of its own in {lost} of {len(p)} frames ({gaps.max() / recording.rate_hz:.2f} s at "
        "the longest): what there is of its markers, and the limb's, tell it there"
    )
    return np.ascontiguousarray(R), np.ascontiguousarray(p), [Note("base_gap", text, columns=marked.base.markers)]
