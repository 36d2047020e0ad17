"""Time of a recording's frames: rates that contradict each other, and what the column of time says."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from limbcal.note import Note
from protocol.markers.recording import RawRecording

#: Rates that differ by less are one.
_SAME = 0.01
#: No camera of a motion laboratory is slower [Hz]: that of a film.
_SLOWEST_HZ = 24.0
#: Ratio of a step to the median step above which frames are missing in between: halfway from one to two steps.
_LEFT_OUT = 1.5
#: Ratio of the frames that the stamps span to those recorded above which the clock has leapt: it bounds memory.
_MOST_LEFT_OUT = 20
_COLUMN = "the column of time"


def timed(raw: RawRecording) -> tuple[list[Note], RawRecording]:
    """Return a recording with its frames at the times of its column of time, and what that contradicts.

    Frames that were left out come back without a marker. Where stamps stand still, run backwards or leap, frames
    are taken one after the other.
    """
    if raw.t is None or len(raw.t) < 2 or not np.isfinite(raw.t).all():
        return clock(raw), raw
    steps = np.diff(raw.t)
    usual = float(np.median(steps))
    if not steps.min() > 0.0:
        k = int(np.argmax(steps <= 0.0))
        why = f"frame {k + 2} is at {raw.t[k + 1]:g} s, the one before it at {raw.t[k]:g} s"
        return _untimed(raw, k, f"time does not rise: {why}")
    wide = steps > _LEFT_OUT * usual
    places = np.concatenate([[0], np.cumsum(np.where(wide, np.rint(steps / usual), 1.0))]).astype(np.int64)
    if places[-1] > _MOST_LEFT_OUT * len(places):
        k = int(np.argmax(steps))
        return _untimed(raw, k, f"time leaps by {steps[k]:.4g} s before frame {k + 2}")
    rate_hz = places[-1] / float(raw.t[-1] - raw.t[0])
    notes = clock(raw)
    if abs(rate_hz / raw.rate_hz - 1.0) * places[-1] > 0.5:  # the last frame is off by half of one
        raw = replace(raw, rate_hz=rate_hz)
    return [*notes, *_left_out(raw, places)], _spread(raw, places)


def clock(raw: RawRecording) -> list[Note]:
    """Say if the rate contradicts the column of time, the analog channels, the header, or any camera."""
    others = dict(raw.other_rates)
    if raw.t is not None and len(raw.t) > 1:
        step = float(np.nanmedian(np.diff(raw.t)))
        if step > 0.0:
            others[_COLUMN] = 1.0 / step
    notes = [
        Note(
            "clock",
            f"the rate is {raw.rate_hz:g} Hz, but {rate:.4g} Hz by {what}"
            + (", which is taken for the truth" if what == _COLUMN else ""),
        )
        for what, rate in others.items()
        if rate > 0.0 and abs(rate / raw.rate_hz - 1.0) > _SAME
    ]
    if not notes and raw.rate_hz < _SLOWEST_HZ:
        text = f"the rate is {raw.rate_hz:g} Hz, slower than any camera of a motion laboratory: it may be wrong"
        notes.append(Note("clock", text))
    return notes


def _untimed(raw: RawRecording, k: int, why: str) -> tuple[list[Note], RawRecording]:
    """Return a recording without its column of time, which is wrong after frame k, counted from 0."""
    text = f"{why}; frames are taken one after the other, at {raw.rate_hz:g} Hz, and may not fit the forces"
    note = Note("clock", text, row=k + 2, from_s=k / raw.rate_hz, to_s=(k + 1) / raw.rate_hz)
    untimed = replace(raw, t=None)
    return [note, *clock(untimed)], untimed


def _left_out(raw: RawRecording, places: NDArray[np.int64]) -> list[Note]:
    notes = []
    for k in np.flatnonzero(np.diff(places) > 1):
        count = int(places[k + 1] - places[k] - 1)
        from_s, to_s = (places[k] + 1) / raw.rate_hz, places[k + 1] / raw.rate_hz
        text = f"{count} frames are left out by the column of time: nothing was seen there"
        notes.append(Note("clock", text, row=int(k) + 2, from_s=float(from_s), to_s=float(to_s)))
    return notes


def _spread(raw: RawRecording, places: NDArray[np.int64]) -> RawRecording:
    """Return a recording with its frames at their places, and frames without a marker between them."""
    n = int(places[-1]) + 1
    if n == len(raw.points):
        return raw
    points, t = np.full((n, *raw.points.shape[1:]), np.nan), np.full(n, np.nan)
    points[places] = raw.points
    if raw.t is not None:
        t[places] = raw.t
    return replace(raw, points=points, t=t)
