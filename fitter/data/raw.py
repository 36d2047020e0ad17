"""Raw accelerations, and angular velocities of gyroscopes, in blocks for a tracker."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm
from fitter.data.even_rate import evened
from fitter.data.gaps import Gap
from fitter.data.leaps import MINIMUM_SAMPLES, split_at_leaps
from fitter.data.motions import Measured, read_file, require_rising
from fitter.data.plausibility.readings import look
from fitter.data.recordings import by_run, read_raw_blocks
from fitter.data.sensor_files import AXES, Part, gyro_axes, gyro_role, join, part_of
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES, JOINT_ROLES, parse_mapping
from protocol.tables.files import RECORDINGS, expand
from tracking.model.readings import Readings, ReadingsBuilder

Floats = NDArray[np.float64]

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
    w : ndarray of shape (n, 3 * n_gyroscope)
        Angular velocities [rad/s]: s1gx s1gy s1gz …
    """

    row: int
    lost: int
    t0_ns: int
    a: Floats
    w: Floats


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
    gyros : tuple of str
        The sensors that come with a gyroscope, in the arm's order.
    w : ndarray of shape (n, 3 * n_gyroscope), or None
        What those read: angular velocity [rad/s] in the sensors' frames; None without any.
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
    gyros: tuple[str, ...] = ()
    w: Floats | None = None

    @property
    def lost(self) -> int:
        """Number of samples that are missing."""
        return sum(gap.samples for gap in self.gaps)

    def blocks(self, rows: int = BLOCK_ROWS) -> Iterator[RawBlock]:
        """Iterate over the samples in blocks of at most some rows; a gap always ends a block."""
        lost = {gap.row: gap.samples for gap in self.gaps}
        bounds = sorted({*range(0, len(self.t), rows), *lost, len(self.t)})
        for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
            t0_ns = round(self.t[begin] * 1e9)
            w = np.empty((end - begin, 0)) if self.w is None else self.w[begin:end]
            yield RawBlock(begin, lost.get(begin, 0), t0_ns, self.a[begin:end], w)

    def readings(self, frame_rate_hz: float) -> Readings:
        """Return the whole run as the smoother takes it, at most at the rate of the samples: ``a``, then ``w``.

        Raises
        ------
        DataError
            If there is no stretch without a gap that would show the noise.
        """
        n_gyro = 3 * len(self.gyros)
        n_channel = self.a.shape[1] + n_gyro
        builder = ReadingsBuilder(self.rate_hz, n_channel, min(frame_rate_hz, self.rate_hz), n_gyro)
        for block in self.blocks():
            if block.lost:
                builder.gap(block.lost)
            builder.push(np.hstack([block.a, block.w]))
        try:
            return builder.done()
        except DataError as error:
            raise DataError(f"run {self.name!r}: {error}") from error

    def with_gyros(self, names: Collection[str]) -> "RawRun":
        """Return a run with no gyroscopes but those of some sensors."""
        kept = [k for k, name in enumerate(self.gyros) if name in names]
        if self.w is None or not kept:
            return replace(self, gyros=(), w=None)
        w = self.w.reshape(len(self.w), -1, 3)[:, kept].reshape(len(self.w), -1)
        return replace(self, gyros=tuple(self.gyros[k] for k in kept), w=w)


def load_raw(
    sources: Sequence[Path],
    sensors: Sequence[str],
    n_joint: int,
    columns: str | None = None,
    *,
    rate_hz: float | None = None,
    arm: Arm | None = None,
    as_filed: bool = True,
) -> list[RawRun]:
    """Read raw accelerations.

    Parameters
    ----------
    sources : sequence of Path
        Files and folders: tables with ``t``, ``s1x s1y s1z …`` and, where there are, ``s1gx s1gy s1gz …`` of
        gyroscopes, and where known ``q1 …``, ``ref1 …`` and ``trial``; one file per sensor, see
        `fitter.data.sensor_files`; or recordings of the daemon (``.mcap``), those of one run read as one.
    sensors : sequence of str
        Names of the sensors in the arm's order, such as ``("s1", "s2")``.
    n_joint : int
        Number of joints of the arm.
    columns : str, optional
        Mapping of foreign columns, see `protocol.tables.columns.parse_mapping`; the axes go by ``s1x`` and so on,
        those of gyroscopes by ``s1gx``.
    rate_hz : float, optional
        Rate of the samples where a file has no time.
    arm : Arm, optional
        Whose sensors the files say they are of: they are questioned, see `fitter.data.plausibility`.
    as_filed : bool
        Sensors are turned as the arm file says; otherwise how is still to be found.

    Returns
    -------
    list of RawRun
        One a file, or one a trial if the clock starts anew with each.

    Raises
    ------
    ConfigError
        If the mapping is wrong, or there is no sensor.
    DataError
        If a file cannot be read or used, or has not all axes of a gyroscope: one sentence with file, column, row.
    """
    if not sensors:
        raise ConfigError("the arm has no [[sensor]], expected one or more whose readings are to be read")
    axes = [f"{sensor}{axis}" for sensor in sensors for axis in AXES]
    rates = {gyro_role(sensor): gyro_axes(sensor) for sensor in sensors if not {*gyro_axes(sensor)} & {*axes}}
    mapping = parse_mapping(columns, n_joint, axes, [axis for three in rates.values() for axis in three])
    files = expand(sources)
    parts: list[Part] = []
    whole: list[Measured] = []
    for together in by_run(files):
        path = together[0]
        if path.suffix.lower() in RECORDINGS:
            gyros = () if arm is None else tuple(arm.sensors[s].name for s in arm.gyroscopes)
            t, a = read_raw_blocks(together, len(axes), 3 * len(gyros))
            found = {gyro_role(name): a[:, 3 * k : 3 * k + 3] for k, name in enumerate(gyros, len(sensors))}
            found = {role: values for role, values in found.items() if values.size}
            where = ", ".join(map(str, together))
            whole.append(Measured(path.stem, where, 0, t, {"a": a[:, : len(axes)], **found}))
        elif len(files) > 1 and (part := part_of(path, sensors, mapping)) is not None:
            parts.append(part)
        else:
            whole += read_file(path, n_joint, mapping, rate_hz, ("a",), {"a": axes, **rates}, SENSED_ROLES)
    whole += join(parts, sensors, mapping)
    runs: list[RawRun] = []
    for clock in (clock for motion in whole for clock in _clocks(motion)):
        pieces = split_at_leaps(clock if arm is None else look(clock, arm, as_filed))
        runs += [replace(_run(piece, sensors), after_leap=k > 0) for k, piece in enumerate(pieces)]
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


def _run(motion: Measured, sensors: Sequence[str]) -> RawRun:
    if len(motion.t) < MINIMUM_SAMPLES:
        raise DataError(
            f"{motion.where}: run {motion.name!r} has {len(motion.t)} samples, expected at least {MINIMUM_SAMPLES}"
        )
    require_rising(motion)
    gyros = tuple(name for name in sensors if gyro_role(name) in motion.columns)
    stamps = motion.t
    motion, dt_s, gaps = evened(motion)
    lost = sum(gap.samples for gap in gaps)
    said = f"{lost} samples lost in {len(gaps)} gap(s), nothing put in their place"
    notes: tuple[Note, ...] = ()
    if gaps:
        row = int(np.searchsorted(stamps, motion.t[gaps[0].row], side="right"))  # in the file, from 1
        notes = (Note("gap", said, columns=("t",), row=motion.first_row + row),)
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
        gyros=gyros,
        w=np.hstack([motion.columns[gyro_role(name)] for name in gyros]) if gyros else None,
    )
