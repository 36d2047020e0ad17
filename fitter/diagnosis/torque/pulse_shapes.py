"""All shapes of a pulse that are sought, made once."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Rows
from fitter.diagnosis.torque.pulse import FORMS, seen

#: Ratio of durations sought: two an octave, neighbours correlated by 0.84.
DURATION_RATIO = np.sqrt(2.0)
#: Digits to which a step is rounded [s]: a nanosecond is nothing.
_STEP_DIGITS = 9


class Shapes:
    """Pulses of size one of all durations and forms that begin with a row, as means over the rows about it.

    Attributes
    ----------
    duration_s, form
        Of each, [s].
    values : (n_shape, n_longest)
    before, length, lasting : (n_shape,)
        From how many rows before the one it begins with, over how many rows, a pulse is felt; how many it lasts.
    """

    def __init__(self, step_s: float, n_sample: int, band_hz: float) -> None:
        pairs = [(float(duration_s), form) for duration_s in durations(step_s) for form in FORMS]
        self.duration_s, self.form = [list(part) for part in zip(*pairs, strict=True)]
        self.lasting = np.array([round(duration_s / step_s) for duration_s, _ in pairs])
        n = int(np.ceil((3.0 * LONGEST_PULSE_S + 2.0 / band_hz) / step_s))  # either side: no end cuts a pulse
        t = step_s * np.arange(-n, n + 1, dtype=np.float64)
        rows = Rows(t, 0.0 * t, np.ones(len(t), dtype=np.bool_), t[:, None], n_sample, band_hz, 0.0, 0.0)
        parts = [seen(rows, -0.5 * step_s, *pair) for pair in pairs]
        self.before = np.array([n - first for first, _ in parts])
        self.length = np.array([len(part) for _, part in parts])
        self.values = np.zeros((len(pairs), int(self.length.max())))
        for row, (_, part) in zip(self.values, parts, strict=True):
            row[: len(part)] = part

    @classmethod
    def of(cls, rows: Rows) -> "Shapes":
        """Return the shapes of some rows: made once for all of the same step."""
        return _shapes(round(rows.step_s, _STEP_DIGITS), rows.n_sample, rows.band_hz)

    def fit(self, rows: Rows) -> NDArray[np.bool_]:
        """Say with which rows a pulse may begin, (n_shape, n): where half of what it lasts is known.

        It may begin or end unseen: a push that stops a joint, or moves one that rests, does.
        """
        n = len(rows.t)
        known = np.concatenate([[0], np.cumsum(rows.known)])
        begin = np.arange(n)
        end = begin + self.lasting[:, None]
        seen = known[np.minimum(end, n)] - known[begin]
        return np.asarray((end < n) & (2 * seen >= self.lasting[:, None]), dtype=np.bool_)


@cache
def _shapes(step_s: float, n_sample: int, band_hz: float) -> Shapes:
    return Shapes(step_s, n_sample, band_hz)


def durations(step_s: float) -> Floats:
    """Return the durations that are sought [s]: from a period of the band's corner, two rows, to the longest.

    What is shorter has no duration in this band.
    """
    n = 1 + max(0, int(np.log(LONGEST_PULSE_S / (2.0 * step_s)) / np.log(DURATION_RATIO)))
    return np.asarray(2.0 * step_s * DURATION_RATIO ** np.arange(n))
