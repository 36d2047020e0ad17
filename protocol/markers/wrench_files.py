"""Forces from outside, as wrenches in the laboratory's frame: MOT and STO tables, and C3D plates."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from limbcal.errors import ConfigError, DataError
from protocol.markers.text_table import number_of, text_of
from protocol.markers.wrench_columns import plate_columns
from protocol.tables.table import Floats
from protocol.tables.units import known_units, parse_unit

#: Lines that a header may have.
_MOST_HEADER = 1000
#: A plate that reads less has nothing on it [N].
EMPTY_N = 10.0
#: Times that differ by less are one [s].
_SAME_S = 1e-9


@dataclass(frozen=True)
class PlateWrench:
    """What one plate gives to whom is on it.

    Attributes
    ----------
    name : str
    t : (n,) [s]
    force, point_m, moment : (n, 3) [N], [m], [N m]
        The force at its point of application and the free moment there, in the laboratory's frame; of a table
        without points, force and moment at the laboratory's origin.
    """

    name: str
    t: Floats
    force: Floats
    point_m: Floats
    moment: Floats

    @property
    def is_loaded(self) -> bool:
        """Whether it ever carries anything."""
        return bool(np.nanmax(np.linalg.norm(self.force, axis=1), initial=0.0) > EMPTY_N)

    def at(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Return force, point and moment at other times, (n, 3) each.

        A point means nothing while a plate is empty and must not be interpolated; the moment about the origin can
        be. Forces are NaN where nothing is known: before the first sample, after the last, and where the file has
        no force, or no point of a force.
        """
        size = np.linalg.norm(self.force, axis=1)
        seen = np.isfinite(self.point_m).all(axis=1)
        unknown = ~np.isfinite(size) | (~seen & (size > EMPTY_N))
        about = np.cross(np.nan_to_num(self.point_m), self.force) + np.nan_to_num(self.moment)
        whole = np.where(unknown[:, None], np.nan, np.hstack([self.force, about]))
        at = np.column_stack([np.interp(t, self.t, column) for column in whole.T])
        at[(t < self.t[0] - _SAME_S) | (t > self.t[-1] + _SAME_S)] = np.nan
        point = np.zeros((len(t), 3))
        if seen.any():
            point = np.column_stack([np.interp(t, self.t[seen], column) for column in self.point_m[seen].T])
        return at[:, :3], point, at[:, 3:] - np.cross(point, at[:, :3])


def read_wrenches(path: Path) -> list[PlateWrench]:
    """Read the plates of a MOT, STO or C3D file.

    Raises
    ------
    ConfigError
        If it cannot be opened, or has another ending.
    DataError
        If it holds no forces, or columns of a plate are missing, stand twice or belong to none.
    """
    suffix = path.suffix.lower()
    if suffix not in (".mot", ".sto", ".c3d"):
        raise ConfigError(f"{path}: its name ends with {suffix or 'nothing'}, expected .mot, .sto or .c3d")
    try:
        plates = _plates_of_c3d(path) if suffix == ".c3d" else _plates_of_table(path)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}") from error
    if not plates:
        raise DataError(f"{path}: it has no forces, expected columns such as ground_force_1_vx, or a plate")
    return plates


def _plates_of_table(path: Path) -> list[PlateWrench]:
    lines = text_of(path).splitlines()
    ends = [k for k, line in enumerate(lines[:_MOST_HEADER]) if line.strip().lower() == "endheader"]
    if not ends:
        raise DataError(f"{path}: no 'endheader' in its first {_MOST_HEADER} lines, expected a MOT or STO file")
    rows = [line for line in lines[ends[0] + 1 :] if line.strip()]
    names = rows[0].split() if rows else []
    if not names or names[0].lower() != "time":
        raise DataError(f"{path}: the first column is {(names or [''])[0][:20]!r}, expected 'time'")
    numbers = np.empty((len(rows) - 1, len(names)))
    for k, row in enumerate(rows[1:]):
        cells = row.split()
        if len(cells) != len(names):
            raise DataError(f"{path}: row {k + 1} has {len(cells)} cells, expected {len(names)}")
        try:
            numbers[k] = [number_of(cell) for cell in cells]
        except ValueError as error:
            raise DataError(f"{path}: row {k + 1}: {error}, expected numbers") from None
    if len(numbers) < 2:
        raise DataError(f"{path}: it has {len(numbers)} samples, expected at least two")
    rises = np.diff(numbers[:, 0]) > 0.0
    if not rises.all():
        k = int(np.argmin(rises))
        raise DataError(
            f"{path}: row {k + 2} is at {numbers[k + 1, 0]:g} s and the one before it at {numbers[k, 0]:g} s, "
            f"expected times that rise"
        )

    def part(of: dict[str, int]) -> Floats:
        axes = [numbers[:, of[axis]] if axis in of else np.zeros(len(numbers)) for axis in "xyz"]
        return np.column_stack(axes)

    return [
        PlateWrench(plate.name, numbers[:, 0], part(plate.force), part(plate.point), part(plate.moment))
        for plate in plate_columns(names, path)
    ]


def _plates_of_c3d(path: Path) -> list[PlateWrench]:
    try:
        import ezc3d  # noqa: PLC0415 - only who has C3D files needs it
    except ImportError:
        raise ConfigError(f"{path}: C3D files need ezc3d; install it with: pip install 'limbcal[human]'") from None
    try:
        file = ezc3d.c3d(str(path), extract_forceplat_data=True)
    except (RuntimeError, ValueError, IndexError) as error:
        raise DataError(f"{path}: its force plates cannot be read: {error}") from error
    rate_hz = float(file["parameters"]["ANALOG"]["RATE"]["value"][0])
    plates = []
    for k, platform in enumerate(file["data"]["platform"]):
        metre = _factor(platform["unit_position"], "length", f"{path}: the position of plate {k + 1}")
        newton_metre = _factor(platform["unit_moment"], "torque", f"{path}: the moment of plate {k + 1}")
        force = np.asarray(platform["force"], dtype=np.float64).T
        point = metre * np.asarray(platform["center_of_pressure"], dtype=np.float64).T
        moment = newton_metre * np.asarray(platform["Tz"], dtype=np.float64).T
        plates.append(PlateWrench(f"plate {k + 1}", np.arange(len(force)) / rate_hz, force, point, moment))
    return plates


def _factor(said: object, dimension: str, where: str) -> float:
    unit = parse_unit(str(said))
    if unit is None or unit.dimension != dimension:
        raise DataError(f"{where} is in {str(said)!r}, expected one of {known_units([dimension])}")
    return unit.factor
