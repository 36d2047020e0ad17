"""The motion in which an arm's markers come nearest to those of a recording."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.effects.marker_effects import marked_in, slid_markers
from arm.marker_kinematics import MarkerChain
from arm.model import Arm, Floats
from fitter.functional.rigid_fit import fit_poses
from fitter.functional.template import doubtful_rms_m
from fitter.limb.base_gaps import carried_by_limb, interpolated
from fitter.limb.base_motion import poses_of
from fitter.limb.floating_base import floating_angles
from fitter.limb.inverse_kinematics import follow, link_poses
from fitter.limb.marked_arm import MarkedArm, marked_arm
from fitter.limb.marker_observations import Frames, base_anywhere
from fitter.limb.motion_smoother import Smoothed, smooth
from limbcal.errors import DataError
from limbcal.note import Note
from limbcal.suggestion import did_you_mean
from protocol.markers.missing import SHORTEST_S
from protocol.markers.recording import MarkerRecording, runs

#: Share of a limb's density of the jerk that a body takes: fifty markers see its trunk where five see a limb's
#: joint, so that the same frequencies pass with a tenth.
JERK_OF_A_BODY = 0.1
#: Least markers of the chain with which a frame determines its angles by itself.
_LEAST_MARKERS = 3
#: Passes in which skin slides with the joints: it slides by centimetres a radian, so each pass leaves a tenth of
#: the error or less.
_PASSES = 3


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
    R, p = _trusted(marked.base.points_m, carried)
    known = np.isfinite(p[:, 0])
    more = _base_gap(recording, marked, known)
    t = recording.t
    everything = np.ascontiguousarray(np.concatenate([y, carried], axis=1))
    frames = Frames(everything, *interpolated(R, p), np.zeros(len(t), dtype=np.int64), t)
    more += _blind(np.isfinite(everything[..., 0]).sum(axis=1), recording.rate_hz)
    chain, std = marked.everything.chain(marked.geometry), marked.everything.std
    sway, prior = marked.markers.sway, marked.angles
    if not sway:
        about = floating_angles(marked.geometry, marked.everything, frames, prior, seed)
        q = follow(chain, frames, std, prior, seed, begin=about)
    elif known.all():
        q = follow(chain, frames, std, prior, seed)
    else:
        prior = base_anywhere(prior)
        q = carried_by_limb(chain, frames, std, prior, known, seed)
    q = _first(q, seen, chain.revolute)
    found = smooth(chain, frames, std, prior, 1.0 / recording.rate_hz, q, 1.0 if sway else JERK_OF_A_BODY)
    if not found.converged:
        more.append(Note("not_converged", "the angles still change where the search ends: do not rely on them"))
    return SolvedMotion(marked, chain, frames, found, (*notes, *more))


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


def _blind(n_seen: NDArray[np.int64], rate_hz: float) -> list[Note]:
    """Say where too few markers of limb and base, (n_frame,), are seen to tell any motion, and for how long."""
    gaps = [run for run in runs(n_seen < _LEAST_MARKERS) if run[1] - run[0] >= SHORTEST_S * rate_hz]
    if not gaps:
        return []
    lost = sum(last - first for first, last in gaps)
    first, last = max(gaps, key=lambda run: run[1] - run[0])
    text = (
        f"fewer than {_LEAST_MARKERS} of the arm's markers are seen in {lost} of {len(n_seen)} frames "
        f"({(last - first) / rate_hz:.2f} s at the longest): the motion there is guessed from before and after, "
        "and q_std says how badly"
    )
    return [Note("gap", text, from_s=first / rate_hz, to_s=last / rate_hz)]


def _base_gap(recording: MarkerRecording, marked: MarkedArm, known: NDArray[np.bool_]) -> list[Note]:
    """Say where the base has no pose of its own, (n_frame,); refuse where it never has."""
    missing = [name for name in marked.base.markers if name not in recording.names]
    if not known.any() and len(missing) == len(marked.base.markers):
        hint = did_you_mean(missing[0], recording.names)
        raise DataError(
            f"{recording.path}: it has none of the base's markers {', '.join(missing)}, expected three of them, "
            f"or all where there are fewer{hint}"
        )
    if not known.any():
        raise DataError(
            f"{recording.path}: no frame shows the base's markers {', '.join(marked.base.markers)} together, "
            "expected three of them, or all where there are fewer"
        )
    gaps = runs(~known)
    if not gaps:
        return []
    first, last = max(gaps, key=lambda run: run[1] - run[0])
    text = (
        f"the base has no pose of its own in {np.sum(~known)} of {len(known)} frames "
        f"({(last - first) / recording.rate_hz:.2f} s at the longest): what there is of its markers, and the "
        "limb's, tell its place there, and its orientation is interpolated"
    )
    return [Note("base_gap", text, columns=marked.base.markers)]
