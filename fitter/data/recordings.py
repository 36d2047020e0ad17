"""What the daemon recorded: frames parted into motions by `limb/trial`, and raw accelerations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray

from fitter.data.block_times import block_times
from fitter.data.drift import dead_reckoned, without_drift
from fitter.data.felt import Felt, felt_of
from fitter.data.motions import Measured
from fitter.data.uncertain_motion import with_uncertain_marked
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.message import FRAMES, RAW, TRIAL
from protocol.recording_reader import read_recording
from protocol.tables.files import RECORDINGS

Floats = NDArray[np.float64]
Fields = Mapping[str, object]

#: The tip of a frame was computed from the arm file's lengths; what measures it are the points.
FRAME_COLUMNS = ("q", "dq", "ddq", "points")
_CLAIM = "q_std"
_NS = 1e-9


@dataclass(frozen=True)
class Window:
    """A motion that the tracker recognised: from rest to rest, in seconds of the recording's clock.

    One that the recording breaks off in goes to the recording's end, where the arm does not rest.
    """

    name: str
    role: str | None
    begin_s: float
    end_s: float
    broken_off: bool = False


def by_run(files: Sequence[Path]) -> list[tuple[Path, ...]]:
    """Return files in the order given, recordings that one run of the daemon went on in together.

    Those of a run stand where the first of them does, in the order in which they were written, which is not that
    of their names.

    Raises
    ------
    DataError, ProtocolError
        If a recording cannot be read.
    """
    groups: dict[object, list[tuple[int, Path]]] = {}
    for path in files:
        run, t_ns = _run_of(path) if path.suffix.lower() in RECORDINGS else (None, 0)
        groups.setdefault(path if run is None else run, []).append((t_ns, path))
    return [tuple(path for _, path in sorted(group)) for group in groups.values()]


def _run_of(path: Path) -> tuple[object, int]:
    """Return the run that a recording is of, if it says so, and the time of its first message [ns]."""
    with read_recording(path, (FRAMES, RAW, TRIAL)) as messages:
        return next(((fields.get("run"), t_ns) for _, fields, t_ns in messages), (None, 0))


def read_frames(files: Sequence[Path], n_joint: int) -> list[Measured]:
    """Read the joint motion of a recording, one motion for every trial announced in it.

    Parameters
    ----------
    files : sequence of Path
        An ``.mcap`` file of the daemon, or those of one run in order, see `by_run`.
    n_joint : int
        Number of joints of the arm.

    Returns
    -------
    list of Measured
        With q, dq, ddq and points, and q_std where the tracker claimed one; the whole recording as one if it
        announces no trial. Where an angle was not known any more it is marked, see
        `fitter.data.uncertain_motion`.

    Raises
    ------
    DataError
        If there are no frames in it or they are of another arm.
    """
    path, where = files[0], ", ".join(map(str, files))
    blocks: list[Fields] = []
    events: dict[tuple[object, ...], Fields] = {}
    damaged: list[Note] = []
    for file in files:
        messages = read_recording(file, (FRAMES, TRIAL))
        for topic, fields, _ in messages:
            if topic == FRAMES:
                blocks.append(fields)
            else:  # the next file repeats what may not have reached the one before
                events.setdefault(tuple(fields.get(name) for name in ("trial", "state", "t_ns")), fields)
        damaged += [Note("damaged", warning) for warning in messages.warnings]
    if not blocks:
        raise DataError(f"{where}: no {FRAMES} in this recording")
    blocks = _once(blocks, "frame0", path)
    start_ns = _whole(blocks[0], "t0_ns", path)
    t = _times(blocks, "frame0", start_ns, path)
    names = (*FRAME_COLUMNS, *([_CLAIM] if all(block.get(_CLAIM) is not None for block in blocks) else []))
    columns = {name: np.concatenate([_array(block, name, path) for block in blocks]) for name in names}
    if columns["q"].shape != (len(t), n_joint):
        found = columns["q"].shape[1:]
        raise DataError(f"{path}: frames of {found} joint angles, expected {n_joint} as the arm has")
    gaps = [bool(block.get("gap")) for block in blocks]
    lost = np.repeat(gaps, [_whole(block, "n", path) for block in blocks])
    notes = tuple(damaged)
    if any(gaps):
        notes = (*notes, Note("lost", f"{sum(gaps)} block(s) of frames after lost samples"))
    windows = _windows(path.stem, list(events.values()), start_ns, float(t[-1]), path)
    if windows:
        spans = [(window.begin_s, window.end_s) for window in windows if not window.broken_off]
        drifting = dead_reckoned(blocks[0].get("method"))
        columns = without_drift(t, columns, spans, drifting)
        said = ", ".join(name for family in drifting for name in family)
        taken = Note("drift", f"drift taken out by the rest at the end of each motion ({said})")
        left = Note("drift", f"the recording ends before the motion does: its drift is left in it ({said})")
    whole = Measured(path.stem, where, 0, t, columns, notes=notes)
    if not windows:
        return [_marked(whole, lost)]
    motions: list[Measured] = []
    before: Window | None = None
    for window in windows:
        begin, end = np.searchsorted(t, [window.begin_s, window.end_s + 0.5 * _NS]).tolist()
        motion = whole.rows(begin, end, window.name, left if window.broken_off else taken)
        motion = _marked(motion, lost[begin:end])
        motions.append(replace(motion, role=window.role, felt=_felt(blocks, window, before, start_ns)))
        before = window
    return [motion for motion in motions if len(motion.t)]


def _marked(motion: Measured, lost: NDArray[np.bool_]) -> Measured:
    claims = {name: motion.columns[_CLAIM] for name in ("q",) if _CLAIM in motion.columns}
    return with_uncertain_marked(motion, lost, claims)


def _felt(blocks: Sequence[Fields], window: Window, before: Window | None, start_ns: int) -> Felt | None:
    """Return what the sensors read around a motion, if it ended; its times are of the recording's clock."""
    if window.broken_off:
        return None
    begin_ns, end_ns = (start_ns + round(at_s / _NS) for at_s in (window.begin_s, window.end_s))
    after_ns = -np.inf if before is None else start_ns + round(before.end_s / _NS)
    try:
        felt = felt_of(blocks, after_ns, begin_ns, end_ns)
    except (LookupError, TypeError, ValueError) as error:
        raise DataError(f"{window.name}: the readings of a block do not fit ({error})") from error
    return None if felt is None else replace(felt, t_s=felt.t_s + window.begin_s)


def read_raw_blocks(files: Sequence[Path], n_channel: int, n_gyro: int = 0) -> tuple[Floats, Floats]:
    """Read the raw readings of a recording.

    Parameters
    ----------
    files : sequence of Path
        An ``.mcap`` file of the daemon, or those of one run in order, see `by_run`.
    n_channel : int
        Channels that the arm's accelerometers have together.
    n_gyro : int
        And its gyroscopes, which need not be in it.

    Returns
    -------
    t : ndarray of shape (n,)
        Time stamps [s] of the device's clock, from the first sample on; lost samples are missing in it.
    a : ndarray of shape (n, n_channel) or (n, n_channel + n_gyro)
        Accelerations [m/s²] and, where it has them, angular velocities [rad/s].

    Raises
    ------
    DataError
        If there are none in it or they have other channels.
    """
    path = files[0]
    blocks: list[Fields] = [fields for file in files for _, fields, _ in read_recording(file, (RAW,))]
    if not blocks:
        raise DataError(f"{', '.join(map(str, files))}: no {RAW} in this recording")
    blocks = _once(blocks, "sample0", path)
    start_ns = _whole(blocks[0], "t0_ns", path)
    t = _times(blocks, "sample0", start_ns, path)
    accelerations = np.concatenate([_array(block, "a", path) for block in blocks])
    if accelerations.shape not in ((len(t), n_channel), (len(t), n_channel + n_gyro)):
        raise DataError(
            f"{path}: raw samples of {accelerations.shape[1:]} channels, expected {n_channel + n_gyro}"
        )
    return t, accelerations


def _windows(stem: str, events: Sequence[Fields], start_ns: int, end_s: float, path: Path) -> list[Window]:
    """Pair the beginnings and ends; a motion that the recording breaks off in goes to its end."""
    windows: list[Window] = []
    begun: tuple[str, str | None, float] | None = None
    for event in events:
        at_s = (_whole(event, "t_ns", path) - start_ns) * _NS
        if begun is not None:
            windows.append(Window(*begun, at_s))
            begun = None
        if event.get("state") == "begin":
            role = event.get("role")
            begun = (f"{stem}/{event.get('trial')}", str(role) if role is not None else None, at_s)
    if begun is not None:
        windows.append(Window(*begun, end_s, broken_off=True))
    return windows


def _once(blocks: Sequence[Fields], first: str, path: Path) -> list[Fields]:
    """Return blocks without those that a file repeats; ``first`` is the field with the number of their first."""
    kept: list[Fields] = []
    reached: int | None = None
    for block in blocks:
        number = _whole(block, first, path)
        if reached is None or number >= reached:
            kept.append(block)
            reached = number + _whole(block, "n", path)
    return kept


def _times(blocks: Sequence[Fields], first: str, start_ns: int, path: Path) -> Floats:
    """Return the times of all samples of blocks [s]; ``first`` is the field with the number of a block's first."""
    steps = [block.get("dt_s") for block in blocks]
    for step in steps:
        if not isinstance(step, float | int):
            raise DataError(f"{path}: dt_s of a block is {step!r}, expected a number")
    numbers, counts, stamps = ([_whole(block, name, path) for block in blocks] for name in (first, "n", "t0_ns"))
    return _NS * block_times(numbers, counts, [stamp - start_ns for stamp in stamps], cast(list[float], steps))


def _whole(fields: Fields, name: str, path: Path) -> int:
    value = fields.get(name)
    if not isinstance(value, int):
        raise DataError(f"{path}: {name} of a block is {value!r}, expected a whole number")
    return value


def _array(block: Fields, name: str, path: Path) -> Floats:
    value = block.get(name)
    if not isinstance(value, np.ndarray) or value.shape[:1] != (_whole(block, "n", path),):
        raise DataError(f"{path}: {name} of a block is {type(value).__name__}, expected one row a sample")
    return value.astype(np.float64)
