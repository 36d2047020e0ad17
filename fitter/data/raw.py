"""Raw accelerations, in blocks for a tracker."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm
from fitter.data.gaps import Gap, find_gaps
from fitter.data.leaps import MINIMUM_SAMPLES, split_at_leaps
from fitter.data.motions import Measured, read_file, require_rising
from fitter.data.plausibility.readings import look
from fitter.data.recordings import read_raw_blocks
from fitter.data.sensor_files import Part, join, part_of
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES, JOINT_ROLES, parse_mapping
from protocol.tables.files import RECORDINGS, expand
from tracking.readings import Readings, ReadingsBuilder

Floats = NDArray[np.float64]

AXES = "xyz"
#: What comes along with readings; what drives the arm is not asked.
SENSED_ROLES = tuple(role for role in JOINT_ROLES if role not in DRIVE_ROLES)
BLOCK_ROWS = 65536


@dataclass(frozen=True)
class RawBlock:
    """A stretch of samples without a gap in it.

    Attributes
    ----------
    row : int
        Row of the run that it begins with.
    lost : int
        Samples that were lost right before it.
    t0_ns : int
        Time of the first sample [ns].
    a : ndarray of shape (n, 3 * n_sensor)
        Accelerations [m/s²]: s1x s1y s1z s2x …
    """

    row: int
    lost: int
    t0_ns: int
    a: Floats


@dataclass(frozen=True)
class RawRun:
    """Samples on one clock.

    Attributes
    ----------
    name : str
        The file's stem, and the trial where the clock starts anew with each.
    rate_hz : float
        Samples a second, gaps not counted.
    t : ndarray of shape (n,)
        Time stamps [s] as in the file.
    a : ndarray of shape (n, 3 * n_sensor)
        Specific force [m/s²] in the sensors' frames.
    gaps : tuple of Gap
        Where samples are missing, and how many.
    q, ref : ndarray of shape (n, n_joint), or None
        True angles, for scoring only, and the controller's target.
    trial : ndarray of str, shape (n,), or None
        Label of the trial that a sample belongs to.
    notes : tuple of Note
        What there is to say about it.
    after_leap : bool
        The run before is of the same file, and the clock leapt between them.
    """

    name: str
    rate_hz: float
    t: Floats
    a: Floats
    gaps: tuple[Gap, ...] = ()
    q: Floats | None = None
    ref: Floats | None = None
    trial: NDArray[np.str_] | None = None
    notes: tuple[Note, ...] = ()
    after_leap: bool = False

    @property
    def lost(self) -> int:
        """Number of samples that are missing."""
        return sum(gap.samples for gap in self.gaps)

    def blocks(self, rows: int = BLOCK_ROWS) -> Iterator[RawBlock]:
        """Iterate over the samples in blocks of at most some rows; a gap always ends a block."""
        lost = {gap.row: gap.samples for gap in self.gaps}
        bounds = sorted({*range(0, len(self.t), rows), *lost, len(self.t)})
        for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
            yield RawBlock(begin, lost.get(begin, 0), round(self.t[begin] * 1e9), self.a[begin:end])

    def readings(self, frame_rate_hz: float) -> Readings:
        """Return the whole run as the smoother takes it, at most at the rate of the samples.

        Raises
        ------
        DataError
            If there is no stretch without a gap that would show the noise.
        """
        builder = ReadingsBuilder(self.rate_hz, self.a.shape[1], min(frame_rate_hz, self.rate_hz))
        for block in self.blocks():
            if block.lost:
                builder.gap(block.lost)
            builder.push(block.a)
        try:
            return builder.done()
        except DataError as error:
            raise DataError(f"run {self.name!r}: {error}") from error


def load_raw(
    sources: Sequence[Path],
    sensors: Sequence[str],
    n_joint: int,
    columns: str | None = None,
    *,
    rate_hz: float | None = None,
    arm: Arm | None = None,
) -> list[RawRun]:
    """Read raw accelerations.

    Parameters
    ----------
    sources : sequence of Path
        Files and folders: tables with ``t``, ``s1x s1y s1z …`` and, where known, ``q1 …``, ``ref1 …`` and
        ``trial``; one file per sensor, see `fitter.data.sensor_files`; or recordings of the daemon (``.mcap``).
    sensors : sequence of str
        Names of the sensors in the arm's order, such as ``("s1", "s2")``.
    n_joint : int
        Number of joints of the arm.
    columns : str, optional
        Mapping of foreign columns, see `protocol.tables.columns.parse_mapping`; the axes go by ``s1x`` and so on.
    rate_hz : float, optional
        Rate of the samples where a file has no time.
    arm : Arm, optional
        Whose sensors the files say they are of: they are questioned, see `fitter.data.plausibility`.

    Returns
    -------
    list of RawRun
        One a file, or one a trial if the clock starts anew with each.

    Raises
    ------
    ConfigError
        If the mapping is wrong, or there is no sensor.
    DataError
        If a file cannot be read or used: one sentence with file, column and row.
    """
    if not sensors:
        raise ConfigError("the arm has no [[sensor]], expected one or more whose readings are to be read")
    axes = [f"{sensor}{axis}" for sensor in sensors for axis in AXES]
    mapping = parse_mapping(columns, n_joint, other_roles=axes)
    files = expand(sources)
    parts: list[Part] = []
    whole: list[Measured] = []
    for path in files:
        if path.suffix.lower() in RECORDINGS:
            t, a = read_raw_blocks(path, len(axes))
            whole.append(Measured(path.stem, str(path), 0, t, {"a": a}))
        elif len(files) > 1 and (part := part_of(path, sensors, mapping)) is not None:
            parts.append(part)
        else:
            whole += read_file(path, n_joint, mapping, rate_hz, ("a",), {"a": axes}, SENSED_ROLES)
    whole += join(parts, sensors, mapping)
    runs: list[RawRun] = []
    for clock in (clock for motion in whole for clock in _clocks(motion)):
        pieces = split_at_leaps(clock if arm is None else look(clock, arm))
        runs += [replace(_run(piece), after_leap=k > 0) for k, piece in enumerate(pieces)]
    return runs


def _clocks(whole: Measured) -> list[Measured]:
    """Part a file where a new trial starts the clock anew."""
    if whole.labels is None:
        return [whole]
    restarts = np.flatnonzero((np.diff(whole.t) <= 0.0) & (whole.labels[1:] != whole.labels[:-1])) + 1
    bounds = [0, *restarts.tolist(), len(whole.t)]
    if len(bounds) == 2:
        return [whole]
    return [
        whole.rows(begin, end, f"{whole.name}/{whole.labels[begin]}")
        for begin, end in zip(bounds[:-1], bounds[1:], strict=True)
    ]


def _run(motion: Measured) -> RawRun:
    if len(motion.t) < MINIMUM_SAMPLES:
        raise DataError(
            f"{motion.where}: run {motion.name!r} has {len(motion.t)} samples, expected at least {MINIMUM_SAMPLES}"
        )
    require_rising(motion)
    dt_s, gaps = find_gaps(motion.t)
    lost = sum(gap.samples for gap in gaps)
    said = f"{lost} samples lost in {len(gaps)} gap(s), nothing put in their place"
    notes = (Note("gap", said, columns=("t",), row=motion.first_row + gaps[0].row + 1),) if gaps else ()
    return RawRun(
        name=motion.name,
        rate_hz=1.0 / dt_s,
        t=motion.t,
        a=motion.columns["a"],
        gaps=gaps,
        q=motion.columns.get("q"),
        ref=motion.columns.get("ref"),
        trial=motion.labels,
        notes=(*motion.notes, *notes),
    )
