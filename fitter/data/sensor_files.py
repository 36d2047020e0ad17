"""One file per sensor, joined on one clock."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fitter.data.derivatives import lowpass
from fitter.data.leaps import MINIMUM_SAMPLES
from fitter.data.motions import Measured
from fitter.data.resample import ANTI_ALIAS, CROWDED, curve_through
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.columns import ColumnMap, dimensions_of
from protocol.tables.files import open_source
from protocol.tables.reader import read_tables
from protocol.tables.source import Source
from protocol.tables.stamps import holes, require_rising
from protocol.tables.table import Floats

AXES = "xyz"
#: What a sensor's own file calls its axes.
_OWN_AXES = ("{}", "a{}", "acc_{}", "acc{}", "accel_{}", "accel{}")
#: And those of its gyroscope.
_OWN_RATES = ("g{}", "w{}", "gyr_{}", "gyr{}", "gyro_{}", "gyro{}")
#: Stamps that agree to this part of a step are the same: nothing is to be resampled.
_SAME = 1e-3

Entries = dict[str, str]
Span = tuple[float, float]


@dataclass(frozen=True)
class Part:
    """A file with some of the sensors.

    Attributes
    ----------
    path : Path
    columns : dict of str to dict of str to str
        By sensor: which column is which axis (``s1x``, and of its gyroscope ``s1gx``).
    run : str
        What the files of one run have in common: their folder, and their name without the sensor's.
    """

    path: Path
    columns: Mapping[str, Entries]
    run: str


@dataclass(frozen=True)
class _Readings:
    """What one sensor read, on its own stamps: ``a`` (n, 3), or with its gyroscope (n, 6)."""

    path: Path
    t: Floats
    a: Floats

    @property
    def step_s(self) -> float:
        return float(np.median(np.diff(self.t)))


def gyro_axes(sensor: str) -> list[str]:
    """Return the roles of the axes of a sensor's gyroscope: ``s1gx s1gy s1gz``."""
    return [f"{sensor}g{axis}" for axis in AXES]


def gyro_role(sensor: str) -> str:
    """Return the name under which a sensor's angular velocities are kept together."""
    return f"{sensor} gyro"


def part_of(path: Path, sensors: Sequence[str], mapping: ColumnMap) -> Part | None:
    """Return which sensors a file has, or None if it has all of them, or none.

    A sensor's columns go by ``s1x s1y s1z``; in a file whose name holds the sensor's (``s1.csv``,
    ``walk_s1.csv``) by ``x y z``, ``ax ay az`` or ``acc_x acc_y acc_z`` too, those of its gyroscope by ``gx gy
    gz``, ``wx wy wz`` or ``gyr_x gyr_y gyr_z``.
    """
    source = open_source(path)
    found: dict[str, Entries] = {}
    for sensor in sensors:
        entries = {f"{sensor}{axis}": mapping.plain(f"{sensor}{axis}") for axis in AXES}
        named = {role: address.text for role, address in entries.items() if address is not None}
        if len(named) == len(AXES) and _has(source, named):
            found[sensor] = named
    if len(found) == len(sensors):
        return None
    run = path.stem
    for sensor in sensors if not found else ():
        token = re.compile(rf"(?<![a-z0-9]){re.escape(sensor.lower())}(?![a-z0-9])")
        if token.search(run.lower()):
            for form in _OWN_AXES:
                own = {f"{sensor}{axis}": form.format(axis) for axis in AXES}
                if _has(source, own):
                    rates = [
                        dict(zip(gyro_axes(sensor), map(form.format, AXES), strict=True)) for form in _OWN_RATES
                    ]
                    own |= next((entries for entries in rates if _has(source, entries, "gyro")), {})
                    return Part(path, {sensor: own}, f"{path.parent}/{token.sub('', run.lower())}")
    return Part(path, found, f"{path.parent}/") if found else None


def join(parts: Sequence[Part], sensors: Sequence[str], mapping: ColumnMap) -> list[Measured]:
    """Read files with one sensor or some each, and join those of one run on one clock.

    Parameters
    ----------
    parts : sequence of Part
    sensors : sequence of str
        All sensors of the arm, in its order.
    mapping : ColumnMap

    Returns
    -------
    list of Measured
        One a run, with ``a`` of shape (n, 3 * n_sensor) and of each gyroscope (n, 3). Rows are left out where one
        of the sensors has a hole.

    Raises
    ------
    DataError
        If a sensor is in no file of a run, or in two; or if two files do not overlap in time.
    """
    runs: dict[str, list[Part]] = {}
    for part in parts:
        runs.setdefault(part.run, []).append(part)
    return [_joined(run, sensors, mapping) for run in runs.values()]


def _has(source: Source, names: Entries, kind: str = "a") -> bool:
    return all(source.match(name, dimensions_of(kind)) is not None for name in names.values())


def _joined(parts: Sequence[Part], sensors: Sequence[str], mapping: ColumnMap) -> Measured:
    files = ", ".join(str(part.path) for part in parts)
    holders = {sensor: [part for part in parts if sensor in part.columns] for sensor in sensors}
    for sensor, holding in holders.items():
        axes = ", ".join(f"{sensor}{axis}" for axis in AXES)
        if not holding:
            raise DataError(f"{files}: none has {axes}, expected a file for sensor {sensor!r} too")
        if len(holding) > 1:
            twice = f"{holding[0].path} and {holding[1].path}"
            raise DataError(f"{twice}: both have {axes}, expected sensor {sensor!r} once a run")
    notes: list[Note] = []
    stated: set[str] = set()
    origins: list[float] = []
    found: list[_Readings] = []
    has_gyro: list[bool] = []
    for sensor in sensors:
        part = holders[sensor][0]
        own = ColumnMap({**mapping.entries, **part.columns[sensor]}, mapping.units, mapping.rates)
        vectors = {"a": [f"{sensor}{axis}" for axis in AXES]}
        if set(gyro_axes(sensor)) <= set(mapping.rates):
            vectors[gyro_role(sensor)] = gyro_axes(sensor)
        (table,) = read_tables(part.path, 1, own, ("a",), vectors=vectors, joint_roles=())
        t = table.groups["t"][:, 0]
        require_rising(t, str(part.path))
        notes += table.notes
        stated |= table.stated
        origins.append(table.origin_s)
        groups = [table.groups[role] for role in vectors if role in table.groups]
        has_gyro.append(len(groups) > 1)
        found.append(_Readings(part.path, t, np.hstack(groups)))
    later = [origin - min(origins) for origin in origins]
    found = [_Readings(one.path, one.t + shift, one.a) for one, shift in zip(found, later, strict=True)]
    t, a, said = _on_one_clock(found)
    notes.append(Note("joined", said, source=files))
    name = parts[0].path.parent.name or parts[0].path.stem
    first = np.cumsum([0, *(3 + 3 * gyro for gyro in has_gyro[:-1])])
    columns = {"a": np.hstack([a[:, k : k + 3] for k in first])}
    columns |= {
        gyro_role(s): a[:, k + 3 : k + 6] for s, k, gyro in zip(sensors, first, has_gyro, strict=True) if gyro
    }
    return Measured(name, files, 0, t, columns, notes=tuple(dict.fromkeys(notes)), stated=frozenset(stated))


def _on_one_clock(found: Sequence[_Readings]) -> tuple[Floats, Floats, str]:
    """Return common stamps, the readings at them side by side, and what was done."""
    first = found[0]
    step_s = max(one.step_s for one in found)
    if all(len(one.t) == len(first.t) and np.abs(one.t - first.t).max() <= _SAME * step_s for one in found):
        return first.t, np.hstack([one.a for one in found]), "joined: the files have the same time stamps"
    late, early = max(found, key=lambda one: one.t[0]), min(found, key=lambda one: one.t[-1])
    if late.t[0] >= early.t[-1]:
        raise DataError(
            f"{late.path} begins at {late.t[0]:.9g} s, when {early.path} has ended at {early.t[-1]:.9g} s: "
            "they do not overlap; expected the files of one run, on one clock"
        )
    spans = [(float(late.t[0]), float(early.t[-1]))]
    for one in found:
        spans = _overlaps(spans, _unbroken(one.t))
    stamps: list[Floats] = []
    readings: list[Floats] = []
    for begin, end in spans:
        k0, k1 = np.ceil((begin - late.t[0]) / step_s - 1e-6), np.floor((end - late.t[0]) / step_s + 1e-6)
        grid = late.t[0] + step_s * np.arange(k0, k1 + 1.0)
        if len(grid) >= MINIMUM_SAMPLES:
            stamps.append(grid)
            readings.append(np.hstack([_at(one, grid, step_s) for one in found]))
    if not stamps:
        raise DataError(
            f"{late.path} and {early.path}: no {MINIMUM_SAMPLES} samples in a row at which every sensor reads, "
            "expected the files of one run, on one clock"
        )
    t = np.concatenate(stamps)
    said = f"joined on one clock from {t[0]:.9g} to {t[-1]:.9g} s and resampled to {1e3 * step_s:.6g} ms"
    return t, np.concatenate(readings), said


def _unbroken(t: Floats) -> list[Span]:
    """Return from when to when stamps go on without a hole."""
    begins, ends = np.append(0, holes(t)), np.append(holes(t) - 1, len(t) - 1)
    return [(float(t[begin]), float(t[end])) for begin, end in zip(begins, ends, strict=True)]


def _overlaps(some: Sequence[Span], others: Sequence[Span]) -> list[Span]:
    """Return the spans of time that are in one of each."""
    found: list[Span] = []
    i = k = 0
    while i < len(some) and k < len(others):
        begin, end = max(some[i][0], others[k][0]), min(some[i][1], others[k][1])
        if begin < end:
            found.append((begin, end))
        if some[i][1] < others[k][1]:
            i += 1
        else:
            k += 1
    return found


def _at(one: _Readings, grid: Floats, step_s: float) -> Floats:
    """Return a sensor's readings at some instants, without what their rate could not carry."""
    begin = max(0, int(np.searchsorted(one.t, grid[0], side="right")) - 1)
    end = int(np.searchsorted(one.t, grid[-1], side="left")) + 1
    t, a = one.t[begin:end], one.a[begin:end]
    steps, own_s = np.diff(t), one.step_s
    crowded = bool(steps.min() < CROWDED * own_s)
    curve = curve_through("a", t, a, crowded)
    if step_s <= 1.5 * own_s:
        return curve(np.clip(grid, t[0], t[-1]))
    fine = t[0] + own_s * np.arange(int((t[-1] - t[0]) / own_s + 1e-6) + 1)
    smooth = lowpass(curve(fine), own_s, ANTI_ALIAS / step_s)
    return curve_through("a", fine, smooth, False)(np.clip(grid, fine[0], fine[-1]))
