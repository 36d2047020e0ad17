"""Markers of recordings to joint motion of a calibrated arm, and to that of the segment that carries its base."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats
from fitter.limb.base_motion import quaternions
from fitter.limb.inverse_kinematics import link_poses, predicted
from fitter.limb.marked_arm import marked_arm
from fitter.limb.solved_motion import solve_motion
from limbcal.note import Note
from protocol.markers.recording import MarkerRecording


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
        Called with how many recordings are done.

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
