"""Where markers were not seen, and what stands in the file instead."""

import numpy as np

from limbcal.note import Note
from protocol.markers.recording import RawRecording, runs

#: What some programs store for a missing marker, apart from zeros, in the file's unit.
_STORED = -16512.0
#: Shorter gaps are bridged by any program and not reported [s].
SHORTEST_S = 0.1


def zeros(names: tuple[str, ...], points: np.ndarray, rate_hz: float) -> tuple[list[Note], np.ndarray]:
    """Say where zeros stand for a marker that was not seen, and return points with NaN instead.

    Parameters
    ----------
    names : tuple of str
    points : (n_frame, n_marker, 3)
        In the file's unit.
    rate_hz : float
    """
    stored = np.all(points == 0.0, axis=2) | np.all(np.abs(points - _STORED) < 1.0, axis=2)
    notes = []
    for k, name in enumerate(names):
        for first, last in _long(stored[:, k], rate_hz):
            times = _times(first, last, len(points), rate_hz)
            what = "zeros" if not points[first, k].any() else f"{_STORED:g}"
            notes.append(
                Note(
                    "zeros",
                    f"{name}: {what} stand for {_lasting(first, last, rate_hz)} in which it was not seen",
                    "",
                    (name,),
                    None,
                    *times,
                )
            )
    return notes, np.where(stored[:, :, None], np.nan, points)


def ended(raw: RawRecording) -> list[Note]:
    """Say if a file ends before all frames that its header states."""
    n = len(raw.points)
    if raw.stated_frames is None or n >= raw.stated_frames:
        return []
    text = f"its header says {raw.stated_frames} frames and it holds {n}: it ends early"
    return [Note("gap", text, from_s=n / raw.rate_hz, to_s=raw.stated_frames / raw.rate_hz)]


def gaps(names: tuple[str, ...], points: np.ndarray, rate_hz: float) -> list[Note]:
    """Say where markers were not seen.

    Parameters
    ----------
    names : tuple of str
    points : (n_frame, n_marker, 3)
        NaN where they were not, before zeros are taken for that.
    rate_hz : float
    """
    notes = []
    for k, name in enumerate(names):
        missing = np.isnan(points[:, k]).any(axis=1)
        for first, last in _long(missing, rate_hz):
            times = _times(first, last, len(points), rate_hz)
            said = "never seen" if times == (None, None) else f"not seen for {_lasting(first, last, rate_hz)}"
            notes.append(Note("gap", f"{name}: {said}", "", (name,), None, *times))
    return notes


def _long(mask: np.ndarray, rate_hz: float) -> list[tuple[int, int]]:
    return [(first, last) for first, last in runs(mask) if (last - first) >= SHORTEST_S * rate_hz]


def _times(first: int, last: int, n: int, rate_hz: float) -> tuple[float | None, float | None]:
    """Return when a run of frames begins and ends [s]; None for the whole recording."""
    return (None, None) if (first, last) == (0, n) else (first / rate_hz, last / rate_hz)


def _lasting(first: int, last: int, rate_hz: float) -> str:
    return f"{(last - first) / rate_hz:.2f} s"
