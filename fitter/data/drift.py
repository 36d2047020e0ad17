"""Taking the drift out of dead reckoning, once the rest at the end of a motion is known.

What is dead-reckoned depends on the tracker: all that the paper's gives out, of the others only how far each
sensor has moved. Between two rests an offset that is left over, and most of the noise, act like a constant error
of acceleration. At the end the arm stands still, so whatever velocity is left then is that error times the
duration: it is taken out as ``c t^2 / 2`` of position, ``c t`` of velocity and ``c`` of acceleration. Where the
motion ends elsewhere than the tracker had thought, what follows starts there too.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Columns = dict[str, Floats]
#: A dead-reckoned column and its derivatives.
Family = tuple[str, ...]

#: The velocity that is left is averaged over this long before the end [s].
_LAST_S = 0.02
_ANGLES: Family = ("q", "dq", "ddq")
_POINTS: Family = ("points",)


def dead_reckoned(method: object) -> tuple[Family, ...]:
    """Return what drifts in the frames of a tracker, by the name of its method."""
    return (_ANGLES, _POINTS) if method == "integrate" else (_POINTS,)


class DriftCorrection:
    """Takes the drift out of one motion after the other; each begins where the one before really ended."""

    def __init__(self) -> None:
        self._shift: Columns = {}

    def moving(self, t: Floats, columns: Columns, families: Sequence[Family]) -> Columns:
        """Return the columns of a motion, from rest to rest, without drift.

        Parameters
        ----------
        t : ndarray of shape (n,)
            Time [s], evenly spaced.
        columns : dict of str to ndarray of shape (n, …)
        families : sequence of Family
            What is corrected of them, where it is there; see `dead_reckoned`.
        """
        corrected = self.resting(columns)
        if len(t) < 3:
            return corrected
        elapsed = t - t[0]
        for names in families:
            if names[0] not in columns:
                continue
            position = columns[names[0]]
            last = int(np.clip(_LAST_S * (len(t) - 1) / elapsed[-1], 1, len(t) - 2))
            left = (position[-2] - position[-2 - last]) / (elapsed[-2] - elapsed[-2 - last])
            c = left / elapsed[-1]
            s = elapsed.reshape(-1, *[1] * (position.ndim - 1))
            for name, error in zip(names, (c * s**2 / 2, c * s, c + 0 * s), strict=False):
                if name in corrected:
                    corrected[name] = corrected[name] - error
            self._shift[names[0]] = self._shift.get(names[0], 0.0) + c * elapsed[-1] ** 2 / 2
        return corrected

    def resting(self, columns: Columns) -> Columns:
        """Return the columns of a rest, moved to where the motion before it really ended."""
        return {name: values - self._shift.get(name, 0.0) for name, values in columns.items()}


def without_drift(
    t: Floats, columns: Columns, motions: Sequence[tuple[float, float]], families: Sequence[Family]
) -> Columns:
    """Return the columns of a whole recording without drift.

    Parameters
    ----------
    t : ndarray of shape (n,)
        Time [s].
    columns : dict of str to ndarray of shape (n, …)
    motions : sequence of (begin, end)
        When the motions began and ended [s], in order.
    families : sequence of Family
        What is corrected, see `dead_reckoned`.
    """
    correction, parts, done = DriftCorrection(), [], 0
    for window in motions:
        begin, end = (int(k) for k in np.searchsorted(t, window))
        parts.append(correction.resting(_rows(columns, done, begin)))
        parts.append(correction.moving(t[begin:end], _rows(columns, begin, end), families))
        done = end
    parts.append(correction.resting(_rows(columns, done, len(t))))
    return {name: np.concatenate([part[name] for part in parts]) for name in columns}


def _rows(columns: Columns, begin: int, end: int) -> Columns:
    return {name: values[begin:end] for name, values in columns.items()}
