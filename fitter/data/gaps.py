"""Samples that are missing in a row of time stamps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from protocol.tables.stamps import HOLE_STEPS

Floats = NDArray[np.float64]

#: A step this many times the usual one may be a gap; a late stamp looks the same at first.
SUSPICIOUS = 1.5
#: Stamps on either side that tell a gap, after which all stamps are late, from one late stamp.
WITNESSES = 16
#: Steps of a window, and the least number of windows, that tell an even rate from its stamps' rounding.
_WINDOW, _WINDOWS = 64, 4


@dataclass(frozen=True)
class Gap:
    """Samples were lost before a row.

    Attributes
    ----------
    row : int
        First row after the gap, from 0.
    samples : int
        How many samples are missing.
    """

    row: int
    samples: int


def find_gaps(t: Floats) -> tuple[float, tuple[Gap, ...]]:
    """Find the step of some time stamps and the gaps in them.

    Parameters
    ----------
    t : ndarray of shape (n,), n >= 2
        Rising time stamps [s], equally spaced but for gaps, rounding, and jitter of up to a fifth of a step.

    Returns
    -------
    dt_s : float
        The mean step, gaps taken into account [s].
    gaps : tuple of Gap
        A single stamp that came late, with the following ones in time, is no gap.
    """
    steps = np.diff(t)
    rough = _rough_step(steps)
    suspects = np.flatnonzero(steps > SUSPICIOUS * rough)
    rows = [gap.row for gap in _tell_gaps(t, suspects, rough)]
    gaps = _tell_gaps(t, suspects, _slope(np.split(t, rows), rough))
    lost = sum(gap.samples for gap in gaps)
    return float(t[-1] - t[0]) / (len(t) - 1 + lost), tuple(gaps)


def _rough_step(steps: Floats) -> float:
    """Return the step of an even rate: the median step, but of stamps that were rounded coarsely.

    At 800 Hz in whole milliseconds steps are 1 or 2 ms, and windows of many are alike within one, holes left out;
    where single samples were lost some windows last longer.
    """
    median = float(np.median(steps))
    short = steps[steps <= HOLE_STEPS * median]
    spans = short[: len(short) // _WINDOW * _WINDOW].reshape(-1, _WINDOW).sum(axis=1)
    if len(spans) < _WINDOWS:
        return median
    usual = float(np.median(spans))
    return usual / _WINDOW if np.abs(spans - usual).max() <= median else median


def _slope(pieces: list[Floats], rough: float) -> float:
    """Return the step that fits all pieces between the gaps best; jitter averages out in it."""
    product = square = 0.0
    for piece in pieces:
        index = np.arange(len(piece)) - 0.5 * (len(piece) - 1)
        product += float(index @ (piece - piece.mean()))
        square += float(index @ index)
    return product / square if square else rough


def _tell_gaps(t: Floats, suspects: NDArray[np.intp], usual: float) -> list[Gap]:
    """Return those long steps after which the stamps stay late."""
    gaps: list[Gap] = []
    first = 0
    for place, k in enumerate(suspects.tolist()):
        following = suspects[place + 1] + 1 if place + 1 < len(suspects) else len(t)
        before = np.arange(max(k + 1 - WITNESSES, first), k + 1)
        after = np.arange(k + 1, min(k + 1 + WITNESSES, following))
        expected = np.median(t[before] + usual * (k + 1 - before))
        found = np.median(t[after] - usual * (after - k - 1))
        samples = round(float(found - expected) / usual)
        if samples > 0:
            gaps.append(Gap(k + 1, samples))
            first = k + 1
    return gaps
