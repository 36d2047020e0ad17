"""Markers that leap: from one frame to the next further than any movement goes on."""

import numpy as np
from scipy.ndimage import median_filter

from limbcal.note import Note
from protocol.markers.recording import runs

#: The third difference of a leap is twice as long. It is this multiple of those about it, and this long at least
#: [m]: a leap of 30 mm, which is more than skin and flickering do.
_TIMES, _LEAST_M = 20.0, 0.06
#: Third differences are compared with those within this time [s].
_ABOUT_S = 0.5
#: A leap away that is followed by one back within this time is one of both [s].
_BACK_S = 2.0


def jumps(names: tuple[str, ...], positions: np.ndarray, rate_hz: float, known: np.ndarray) -> list[Note]:
    """Say where markers leap.

    Parameters
    ----------
    names : tuple of str
    positions : (n_frame, n_marker, 3) [m]
    rate_hz : float
    known : (n_frame, n_marker) of bool
        Where a leap has another cause, as where labels are exchanged.
    """
    notes = []
    for k, name in enumerate(names):
        leaps = [at for at in leaps_of(positions[:, k], rate_hz) if not known[max(at - 2, 0) : at + 2, k].any()]
        while leaps:
            first = leaps.pop(0)
            back = next((at for at in leaps if at - first <= _BACK_S * rate_hz), None)
            if back is not None:
                leaps = [at for at in leaps if at > back]
            last = first if back is None else back
            size = float(np.linalg.norm(positions[first, k] - positions[first - 1, k]))
            text = f"{name}: it leaps {1e3 * size:.0f} mm from one frame to the next"
            notes.append(Note("jump", text, "", (name,), None, first / rate_hz, last / rate_hz))
    return notes


def leaps_of(path: np.ndarray, rate_hz: float) -> list[int]:
    """Return the frames to which a marker leaps, from its path (n_frame, 3) [m]."""
    if len(path) < 5:
        return []
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    third = np.zeros(len(path))
    third[2:-1] = np.linalg.norm(np.diff(path, 3, axis=0), axis=1)
    third[np.isnan(third)] = 0.0
    size = 2 * round(_ABOUT_S * rate_hz / 2.0) + 1
    usual = median_filter(third, size=min(size, len(third)), mode="nearest")
    large = (third > _TIMES * usual) & (third > _LEAST_M)
    found = []
    for first, last in runs(large):
        within = steps[max(first - 1, 0) : last]
        if np.any(np.isfinite(within)):
            found.append(max(first - 1, 0) + int(np.nanargmax(within)) + 1)
    return found
