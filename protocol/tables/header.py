"""The names of a file's columns, with the units that stand in them or below them."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path

from limbcal.errors import DataError
from protocol.tables.units import Unit, known_units, parse_unit, split_unit


class Header:
    """Columns by name.

    Parameters
    ----------
    path : Path
        The file, for errors.
    names : sequence of str
        In the file's order. Columns without a name are never asked for.
    units : mapping of str to str, optional
        What stands below a name in a row of units.
    """

    def __init__(self, path: Path, names: Sequence[str], units: Mapping[str, str] | None = None) -> None:
        self.path = path
        self.names = tuple(name for name in names if name)
        self._below = dict(units or {})
        self._count = Counter(self.names)
        self._bare: dict[str, list[str]] = {}
        for name in self._count:
            bare, unit, _ = split_unit(name)
            if unit is not None:
                self._bare.setdefault(bare, []).append(name)

    def match(self, wanted: str, dimensions: Collection[str]) -> str | None:
        """Return the full name of the column that is wanted by its name, with or without its unit.

        Raises
        ------
        DataError
            If several columns are of that name.
        """
        if self._count[wanted] > 1:
            raise DataError(f"{self.path}: column {wanted!r} is there {self._count[wanted]} times, expected once")
        if wanted in self._count:
            return wanted
        found = [name for name in self._bare.get(wanted, []) if self._may_be_unit(name, dimensions)]
        if len(found) > 1:
            raise DataError(
                f"{self.path}: {wanted!r} may be any of the columns {', '.join(found)}; expected one, or "
                f"--columns to say which"
            )
        return found[0] if found else None

    def unit(self, name: str, dimensions: Collection[str]) -> Unit | None:
        """Return the unit that the file states for a column.

        Raises
        ------
        DataError
            If it cannot be the unit of such a column, or is none that is known.
        """
        below = self._below.get(name)
        if below is not None:
            unit = parse_unit(below)
            if unit is None:
                raise DataError(
                    f"{self.path}: column {name!r} is in {below!r}, expected one of {known_units(dimensions)}"
                )
            return require_fit(unit, dimensions, f"{self.path}: column {name!r}")
        _, unit, certain = split_unit(name)
        if unit is None or not (certain or unit.dimension in dimensions):
            return None
        return require_fit(unit, dimensions, f"{self.path}: column {name!r}")

    def nearest(self, wanted: str) -> str | None:
        """Return the column whose name is most like one that is not there."""
        by_lower = {name.lower(): name for name in self._count}
        found = get_close_matches(wanted.lower(), by_lower, n=1, cutoff=0.7)
        starts = [name for name in self._count if name.startswith((f"{wanted} ", f"{wanted}["))]
        return starts[0] if starts else by_lower[found[0]] if found else None

    def _may_be_unit(self, name: str, dimensions: Collection[str]) -> bool:
        _, unit, certain = split_unit(name)
        return unit is not None and (certain or unit.dimension in dimensions)


def require_fit(unit: Unit, dimensions: Collection[str], where: str) -> Unit:
    """Return a unit, or raise a DataError if it measures something else than it is to."""
    if unit.dimension not in dimensions:
        measured = f"{'an' if unit.dimension[0] in 'aeiou' else 'a'} {unit.dimension}"
        raise DataError(
            f"{where} is in {unit.name}, which measures {measured}; expected one of {known_units(dimensions)}"
        )
    return unit


class HeadedFile:
    """A file whose columns are what its header names."""

    _header: Header

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns in the file's order."""
        return self._header.names

    def match(self, wanted: str, dimensions: Collection[str]) -> str | None:
        """Return the full name of a column, see `Header.match`."""
        return self._header.match(wanted, dimensions)

    def unit(self, address: str, dimensions: Collection[str]) -> Unit | None:
        """Return the unit that the header, or the row below it, states."""
        return self._header.unit(address, dimensions)

    def nearest(self, wanted: str) -> str | None:
        """Return the name that is most like one that is not there."""
        return self._header.nearest(wanted)
