"""Units and the axis that points up, from how large people are and how they stand."""

import numpy as np

from limbcal.note import Note

#: Units of length that a header may name [m].
UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "in": 0.0254, "inch": 0.0254, "": 1.0}
#: Mean distance of a person's markers from their middle [m]: from a hand's to two persons' beside a wheelchair.
_SMALLEST_M, _LARGEST_M = 0.04, 3.0
#: … and of a whole person's [m].
_USUAL_M = 0.5
#: A whole body stands up along the axis in which it is so much longer than in the others.
_LONGER = 1.3
#: A floor lies at zero: this part of the height may lie below it.
_BELOW = 0.1


def unit_of(points: np.ndarray, said: str) -> tuple[list[Note], str]:
    """Say if the unit contradicts the size of a person, and return the one that fits.

    Parameters
    ----------
    points : (n_frame, n_marker, 3)
        In the file's unit.
    said : str
        The header's unit.
    """
    named = said.strip().lower()
    size = _size(points)
    if not size > 0.0:
        return [], named or "m"

    def fits(unit: str) -> bool:
        return _SMALLEST_M <= size * UNITS[unit] <= _LARGEST_M

    if named in UNITS and fits(named):
        return [], named or "m"
    others = [unit for unit in ("m", "mm", "cm") if fits(unit)]
    if not others:
        return [], named if named in UNITS else "m"
    used = min(others, key=lambda unit: abs(np.log(size * UNITS[unit] / _USUAL_M)))
    length = f"{size:.3g} {said or 'without a unit'}"
    text = f"its markers lie {length} from their middle: the lengths are {used}, and taken for that"
    inches_m = size * UNITS["in"]
    if fits("in") and abs(np.log(inches_m / _USUAL_M)) < abs(np.log(size * UNITS[used] / _USUAL_M)):
        text += f"; were they inches it would be {inches_m:.2g} m, as of a whole person"
    return [Note("unit", text)], used


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
    seen = np.isfinite(positions).all(axis=2).sum(axis=1) > 1
    if not np.any(seen):
        return [], said
    some = positions[seen]
    extents = np.nanmedian(np.nanmax(some, axis=1) - np.nanmin(some, axis=1), axis=0)
    order = np.argsort(extents)[::-1]
    if extents[order[0]] < _LONGER * extents[order[1]]:
        return [], said
    axis = int(order[0])
    low, high = np.nanquantile(some[:, :, axis], [0.0, 1.0])
    floor = _BELOW * (high - low)
    if not (low > -floor or high < floor):  # the origin is in mid-air: nothing tells head from feet
        return [], said
    found = ("+" if low > -floor else "-") + "xyz"[axis]
    if not said or said == found:
        return [], found
    text = f"the header calls {said} up, but its markers stand along {found}: that is taken for up"
    return [Note("up", text)], found
