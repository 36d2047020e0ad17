"""Frames and marks of a recording, from a file of it and those in which its run went on."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import DataError, LimbcalError, ProtocolError
from limbcal.note import Note
from playback.trajectory import Bools, Floats
from protocol.message import FRAMES, TRIAL
from protocol.recording_files import files_of, number_of
from protocol.recording_reader import read_recording


class Mark(NamedTuple):
    """A motion begins or ends."""

    state: str
    trial: int
    t_ns: int


@dataclass(frozen=True)
class RecordedFrames:
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


def read_recorded(path: Path) -> tuple[RecordedFrames, list[Mark], list[Note]]:
    """Read a file of a recording and those that follow it.

    Returns
    -------
    frames : RecordedFrames
    marks : list of Mark
    notes : list of Note
        What cannot be read or is not there.

    Raises
    ------
    DataError
        If there are no frames, or the file cannot be opened.
    ProtocolError
        If a file is no recording, or a message in it is not as agreed.
    """
    blocks: list[RecordedFrames] = []
    marks: list[Mark] = []
    files, notes = _following(path)
    run: object = None
    for file in files:
        reached = _next_number(blocks)
        try:
            reader = read_recording(file, (FRAMES, TRIAL))
        except LimbcalError as error:
            if file == path:
                raise
            notes.append(Note("unused", f"{error}; it is not played"))
            continue
        with reader:
            for topic, fields, _ in reader:
                run = fields.get("run") if run is None else run
                if fields.get("run") != run:
                    notes.append(Note("unused", f"it is of another run than {path}: not played", str(file)))
                    break
                try:
                    _take(topic, fields, blocks, marks, reached)
                except (KeyError, TypeError, ValueError) as error:
                    raise ProtocolError(f"{file}: a {topic} message has no usable field {error}") from error
            notes += [Note("damaged", sentence) for sentence in reader.warnings]
    if not blocks:
        raise DataError(f"{path}: it holds no {FRAMES}, expected a recording of a tracked motion")
    return _joined(blocks, path), marks, notes


def _take(
    topic: str, fields: Mapping[str, Any], blocks: list[RecordedFrames], marks: list[Mark], reached: int
) -> None:
    """Add what a message holds, unless a file before holds it, too.

    After a disk failed, the next file repeats what may not have reached the one before.
    """
    if topic == TRIAL:
        mark = Mark(str(fields["state"]), int(fields["trial"]), int(fields["t_ns"]))
        if mark not in marks:
            marks.append(mark)
        return
    block = _block(fields)
    if not len(block.number) or block.number[0] >= reached:
        blocks.append(block)


def _following(path: Path) -> tuple[list[Path], list[Note]]:
    """Return a file of a recording and those after it, and say which are not there."""
    files = files_of(path)
    if path not in files:
        return [path], []
    files = files[files.index(path) :]
    notes = []
    for before, after in pairwise(files):
        if gone := number_of(after) - number_of(before) - 1:
            text = f"{gone} file(s) between {before.name} and {after.name} are not there: not played"
            notes.append(Note("lost", text, str(path)))
    return files, notes


def _next_number(blocks: list[RecordedFrames]) -> int:
    """Return the number of the frame that follows."""
    last = next((block.number[-1] for block in reversed(blocks) if len(block.number)), -1)
    return int(last) + 1


def _block(fields: Mapping[str, Any]) -> RecordedFrames:
    dt_s = float(fields["dt_s"])
    q, dq, ddq = (np.asarray(fields[name], dtype=np.float64) for name in ("q", "dq", "ddq"))
    if q.ndim != 2 or not q.shape == dq.shape == ddq.shape:
        raise ValueError(f"q, dq, ddq (of shapes {q.shape}, {dq.shape}, {ddq.shape})")
    index = np.arange(len(q))
    lost = np.zeros(len(q), dtype=bool)
    lost[:1] = bool(fields["gap"])
    t_ns = int(fields["t0_ns"]) + np.round(index * dt_s * 1e9).astype(np.int64)
    number = int(fields["frame0"]) + index
    return RecordedFrames(number, t_ns, q, dq, ddq, lost, np.zeros(len(q)), dt_s, str(fields["method"]))


def _joined(blocks: list[RecordedFrames], path: Path) -> RecordedFrames:
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
    return RecordedFrames(number, t_ns, q, dq, ddq, lost, np.concatenate(since_s), first.dt_s, first.method)
