"""Units and the axis that points up, from how large people are and how they stand."""

import numpy as np

from limbcal.note import Note
from protocol.tables.units import Unit, parse_unit

#: What is tried where the header's unit is none, or cannot be.
_METRE, _MILLIMETRE, _CENTIMETRE, _INCH = (
    Unit(name, "length", factor) for name, factor in (("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254))
)
#: Mean distance of a person's markers from their middle [m]: from a hand's to two persons' beside a wheelchair.
_SMALLEST_M, _LARGEST_M = 0.04, 3.0
#: … and of a whole person's [m].
_USUAL_M = 0.5
#: A whole body stands up along an axis in which it is this many times longer than in the others.
_LONGER = 1.3
#: A floor lies at zero: the lowest marker may be below it in any frame, and above it in the median one, by these
#: parts of the height.
_BELOW, _ABOVE = 0.1, 0.2


def unit_of(points: np.ndarray, said: str) -> tuple[list[Note], Unit]:
    """Say if the unit contradicts the size of a person, and return the one that fits.

    Parameters
    ----------
    points : (n_frame, n_marker, 3)
        In the file's unit.
    said : str
        The header's unit, as `protocol.tables.units.parse_unit` reads it, in any case; empty if it names none.

    Returns
    -------
    notes : list of Note
        Where the unit is not the header's, or a guess.
    unit : Unit
        Metres where nothing tells.
    """
    named = _length(said)
    size = _size(points)
    if not size > 0.0:
        return [], named or _METRE

    def fits(unit: Unit) -> bool:
        return _SMALLEST_M <= size * unit.factor <= _LARGEST_M

    if named is not None and fits(named):
        return [], named
    if not said.strip() and fits(_METRE):
        return [], _METRE
    away = f"its markers lie {size:.3g} {said.strip() or 'without a unit'} from their middle"
    if said.strip() and named is None:
        away = f"its header's unit {said.strip()!r} is not known; {away}"
    likely = [unit for unit in (_METRE, _MILLIMETRE, _CENTIMETRE) if fits(unit)]
    if not likely:
        used = named or _METRE
        return [Note("unit", f"{away}, which is no person's size in any unit: taken for {used.name}")], used
    used = min(likely, key=lambda unit: abs(np.log(size * unit.factor / _USUAL_M)))
    text = f"{away}: the lengths are taken for {_metres(size, used)}"
    others = [unit for unit in (*likely, _INCH) if unit != used and fits(unit)]
    if others:
        text += f"; {' or '.join(_metres(size, unit) for unit in others)} would fit a person, too"
    return [Note("unit", text)], used


def _metres(size: float, unit: Unit) -> str:
    return f"{unit.name} ({size * unit.factor:.2g} m)"


def _length(said: str) -> Unit | None:
    """Return the unit of length that a header names, in any case: it measures nothing else."""
    unit = parse_unit(said) or parse_unit(said.lower())
    return unit if unit is not None and unit.dimension == "length" else None


def _size(points: np.ndarray) -> float:
    """Return the median over frames of the markers' mean distance from their middle."""
    some = points[np.isfinite(points).all(axis=2).sum(axis=1) > 1]
    if not len(some):
        return 0.0
    away = np.linalg.norm(some - np.nanmedian(some, axis=1, keepdims=True), axis=2)
    return float(np.nanmedian(np.nanmean(away, axis=1)))


def up_of(positions: np.ndarray, said: str) -> tuple[list[Note], str]:
    """Say if the header's axis up contradicts a person who stands, and return the one that fits.

    Parameters
    ----------
    positions : (n_frame, n_marker, 3) [m]
    said : str
        Such as ``+z``; empty if the header says nothing.
    """
    found = stands_along(positions, said)
    if not found or not said or said == found:
        return [], found or said
    text = f"the header calls {said} up, but its markers stand along {found}: that is taken for up"
    return [Note("up", text)], found


def stands_along(positions: np.ndarray, said: str) -> str:
    """Return the axis that points up by a person who stands, such as ``+z``; empty where none tells.

    Somebody who is about as wide as tall, by arms that are held out or markers on the floor, does not contradict
    the header's axis, and still tells its sign: the floor is where the markers reach zero. An arm that moves is as
    long as that, but does not stand on a floor.

    Parameters
    ----------
    positions : (n_frame, n_marker, 3) [m]
    said : str
        What the header calls up; empty if it says nothing.
    """
    seen = np.isfinite(positions).all(axis=2).sum(axis=1) > 1
    if not np.any(seen):
        return ""
    some = positions[seen]
    extents = np.median(np.nanmax(some, axis=1) - np.nanmin(some, axis=1), axis=0)
    order = np.argsort(extents)[::-1]
    axis = int(order[0])
    stands = bool(extents[axis] >= _LONGER * extents[order[1]])
    if not stands and said and _LONGER * extents["xyz".index(said[1])] >= extents[axis]:
        axis = "xyz".index(said[1])
    elif not stands:
        return ""
    ends = np.array([np.nanmin(some[:, :, axis], axis=1), -np.nanmax(some[:, :, axis], axis=1)])
    tall = -float(np.sum(np.median(ends, axis=1)))
    above, below = (end.min() > -_BELOW * tall and np.median(end) < _ABOVE * tall for end in ends)
    if not (above or below):  # the origin is in mid-air, or somebody reaches out far from it
        return ""
    return ("+" if above else "-") + "xyz"[axis]
