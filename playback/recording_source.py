"""A recording of the daemon as something to play."""

from pathlib import Path

import numpy as np

from arm.arm_file import parse_arm
from arm.model import Arm
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note
from playback.recorded_frames import Mark, RecordedFrames, read_recorded
from playback.source import Source
from playback.trajectory import Bools, Trajectory
from protocol.recording import ARM_ATTACHMENT
from protocol.recording_reader import recording_attachments

_Spans = dict[int, tuple[int, int]]

_FOREVER_NS = np.iinfo(np.int64).max


def recording_source(path: Path, arm: Arm | None) -> Source:
    """Read the motions that `limb/trial` marks in what `limb/frames` tells.

    Parameters
    ----------
    path : Path
        MCAP file; one whose writer was killed is played up to its end. The files in which its run went on are
        played, too; a trial that began in a file before is not.
    arm : Arm or None
        The arm that moves; the one attached to the recording unless given.

    Returns
    -------
    Source
        Its notes tell what is played otherwise than it might seem, or not at all.

    Raises
    ------
    DataError
        If the recording holds no motion.
    ProtocolError
        If it is no recording, or a message in it is not as agreed.
    ConfigError
        If the arm is missing, wrong, or has another number of joints.
    """
    arm = _attached_arm(path) if arm is None else arm
    frames, marks, notes = read_recorded(path)
    if frames.q.shape[1] != arm.n_joint:
        moved = frames.q.shape[1]
        raise ConfigError(f"{path}: it moves {moved} joint(s), but the arm {arm.name!r} has {arm.n_joint}")
    spans = _spans(marks, path, notes)
    if not spans:
        what = "begins" if marks else "is marked"
        notes.append(Note("trials", f"no motion {what} in it, so all of it is played as trial 1", str(path)))
        spans = {1: (0, _FOREVER_NS)}
    motions, begins_s = {}, {}
    for trial, span in sorted(spans.items()):
        chosen = (frames.t_ns >= span[0]) & (frames.t_ns <= span[1])
        if np.count_nonzero(chosen) < 2:
            text = f"trial {trial} is left out, since the recording holds no frames of it"
            notes.append(Note("trials", text, str(path)))
            continue
        try:
            motions[trial] = _trajectory(frames, chosen)
            begins_s[trial] = float(frames.t_ns[chosen][0]) * 1e-9
        except DataError as error:
            raise DataError(f"{path}: trial {trial}: {error}") from error
    if not motions:
        raise DataError(f"{path}: it holds the frames of no trial, expected at least one")
    durations = {trial: motion.duration_s for trial, motion in motions.items()}
    return Source(path.name, arm, durations, motions.__getitem__, notes=tuple(notes), begins_s=begins_s)


def _attached_arm(path: Path) -> Arm:
    attached = recording_attachments(path).get(ARM_ATTACHMENT)
    if attached is None:
        raise ConfigError(f"{path}: no arm is attached to it, expected --arm")
    return parse_arm(attached.decode("utf-8", errors="replace"), f"{ARM_ATTACHMENT} in {path}")


def _spans(marks: list[Mark], path: Path, notes: list[Note]) -> _Spans:
    """Return when each motion began and ended; one that was cut off lasts to the end."""
    spans: _Spans = {}
    for mark in marks:
        if mark.state == "begin":
            if mark.trial in spans:
                raise DataError(f"{path}: trial {mark.trial} begins twice, expected each number once")
            spans[mark.trial] = (mark.t_ns, _FOREVER_NS)
        elif mark.trial in spans:
            spans[mark.trial] = (spans[mark.trial][0], mark.t_ns)
        else:
            text = f"trial {mark.trial} is left out, since it began before this file"
            notes.append(Note("trials", text, str(path)))
    return spans


def _trajectory(frames: RecordedFrames, chosen: Bools) -> Trajectory:
    t = frames.since_s[chosen]
    t = t - t[0]
    q, dq, ddq = frames.q[chosen], frames.dq[chosen], frames.ddq[chosen]
    return Trajectory(t, q, dq, ddq, frames.method, frames.lost[chosen])
