"""A recording of the daemon as something to play."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.arm_file import parse_arm
from arm.model import Arm
from limbcal.errors import ConfigError, DataError, ProtocolError
from playback.source import Source
from playback.trajectory import Bools, Floats, Trajectory
from protocol.message import FRAMES, TRIAL
from protocol.recording import ARM_ATTACHMENT
from protocol.recording_reader import read_recording, recording_attachments

_Spans = dict[int, tuple[int, int]]

_FOREVER_NS = np.iinfo(np.int64).max


class _Mark(NamedTuple):
    """A motion begins or ends."""

    state: str
    trial: int
    t_ns: int


@dataclass(frozen=True)
class _Frames:
    """Frames end to end.

    Attributes
    ----------
    number, t_ns : (n,)
    since_s : (n,)
        Time by the device's own rate, which counts samples and so is even, where times of the host would jitter.
    q, dq, ddq : (n, n_joint)
    lost : (n,)
        Where some were lost before.
    """

    number: NDArray[np.int64]
    t_ns: NDArray[np.int64]
    q: Floats
    dq: Floats
    ddq: Floats
    lost: Bools
    since_s: Floats
    dt_s: float
    method: str


def recording_source(path: Path, arm: Arm | None, warn: Callable[[str], None]) -> Source:
    """Read the motions that `limb/trial` marks in what `limb/frames` tells.

    Parameters
    ----------
    path : Path
        MCAP file; one whose writer was killed is played up to its end.
    arm : Arm or None
        The arm that moves; the one attached to the recording unless given.
    warn : callable
        Takes a sentence about what is played otherwise than it might seem.

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
    frames, marks = _read(path, warn)
    if frames.q.shape[1] != arm.n_joint:
        moved = frames.q.shape[1]
        raise ConfigError(f"{path}: it moves {moved} joint(s), but the arm {arm.name!r} has {arm.n_joint}")
    spans = _spans(marks, path)
    if not spans:
        warn(f"{path}: no motion is marked in it, so all of it is played as trial 1")
        spans = {1: (0, _FOREVER_NS)}
    motions = {}
    for trial, span in sorted(spans.items()):
        chosen = (frames.t_ns >= span[0]) & (frames.t_ns <= span[1])
        if np.count_nonzero(chosen) < 2:
            warn(f"{path}: trial {trial} is left out, since the recording holds no frames of it")
            continue
        try:
            motions[trial] = _trajectory(frames, chosen)
        except DataError as error:
            raise DataError(f"{path}: trial {trial}: {error}") from error
    if not motions:
        raise DataError(f"{path}: it holds the frames of no trial, expected at least one")
    durations = {trial: motion.duration_s for trial, motion in motions.items()}
    return Source(path.name, arm, durations, motions.__getitem__)


def _attached_arm(path: Path) -> Arm:
    attached = recording_attachments(path).get(ARM_ATTACHMENT)
    if attached is None:
        raise ConfigError(f"{path}: no arm is attached to it, expected --arm")
    return parse_arm(attached.decode("utf-8", errors="replace"), f"{ARM_ATTACHMENT} in {path}")


def _read(path: Path, warn: Callable[[str], None]) -> tuple[_Frames, list[_Mark]]:
    blocks: list[_Frames] = []
    marks: list[_Mark] = []
    reader = read_recording(path, (FRAMES, TRIAL))
    for topic, fields, _ in reader:
        try:
            if topic == TRIAL:
                marks.append(_Mark(str(fields["state"]), int(fields["trial"]), int(fields["t_ns"])))
            else:
                blocks.append(_block(fields))
        except (KeyError, TypeError, ValueError) as error:
            raise ProtocolError(f"{path}: a {topic} message has no usable field {error}") from error
    for sentence in reader.warnings:
        warn(sentence)
    if not blocks:
        raise DataError(f"{path}: it holds no {FRAMES}, expected a recording of a tracked motion")
    return _joined(blocks, path), marks


def _block(fields: Mapping[str, Any]) -> _Frames:
    dt_s = float(fields["dt_s"])
    q, dq, ddq = (np.asarray(fields[name], dtype=np.float64) for name in ("q", "dq", "ddq"))
    if q.ndim != 2 or not q.shape == dq.shape == ddq.shape:
        raise ValueError(f"q, dq, ddq (of shapes {q.shape}, {dq.shape}, {ddq.shape})")
    index = np.arange(len(q))
    lost = np.zeros(len(q), dtype=bool)
    lost[:1] = bool(fields["gap"])
    t_ns = int(fields["t0_ns"]) + np.round(index * dt_s * 1e9).astype(np.int64)
    number = int(fields["frame0"]) + index
    return _Frames(number, t_ns, q, dq, ddq, lost, np.zeros(len(q)), dt_s, str(fields["method"]))


def _joined(blocks: list[_Frames], path: Path) -> _Frames:
    first = blocks[0]
    since_s: list[Floats] = []
    # numbers count from where the step last changed
    dt_s, number0, begin_s = first.dt_s, int(first.number[0]) if len(first.number) else 0, 0.0
    for block in blocks:
        if block.q.shape[1] != first.q.shape[1]:
            raise ProtocolError(
                f"{path}: frames of {first.q.shape[1]} joints are followed by frames of {block.q.shape[1]}, "
                "expected no change"
            )
        if block.dt_s != dt_s and len(block.number):
            begin_s += (int(block.number[0]) - number0) * dt_s
            dt_s, number0 = block.dt_s, int(block.number[0])
        since_s.append(np.asarray(begin_s + (block.number - number0) * dt_s, dtype=np.float64))
    number, t_ns, q, dq, ddq, lost = (
        np.concatenate([getattr(block, name) for block in blocks])
        for name in ("number", "t_ns", "q", "dq", "ddq", "lost")
    )
    lost[1:] |= np.diff(number) > 1
    return _Frames(number, t_ns, q, dq, ddq, lost, np.concatenate(since_s), first.dt_s, first.method)


def _spans(marks: list[_Mark], path: Path) -> _Spans:
    """Return when each motion began and ended; one that was cut off lasts to the end."""
    spans: _Spans = {}
    for mark in marks:
        if mark.state == "begin":
            if mark.trial in spans:
                raise DataError(f"{path}: trial {mark.trial} begins twice, expected each number once")
            spans[mark.trial] = (mark.t_ns, _FOREVER_NS)
        elif mark.trial in spans:
            spans[mark.trial] = (spans[mark.trial][0], mark.t_ns)
    return spans


def _trajectory(frames: _Frames, chosen: Bools) -> Trajectory:
    t = frames.since_s[chosen]
    t = t - t[0]
    q, dq, ddq = frames.q[chosen], frames.dq[chosen], frames.ddq[chosen]
    return Trajectory(t, q, dq, ddq, frames.method, frames.lost[chosen])
