"""Rates that contradict each other."""

import numpy as np

from limbcal.note import Note
from protocol.markers.recording import RawRecording

#: Rates that differ by less are one.
_SAME = 0.01
#: No camera of a motion laboratory is slower [Hz]: that of a film.
_SLOWEST_HZ = 24.0


def clock(raw: RawRecording) -> list[Note]:
    """Say if the rate contradicts the column of time, the analog channels, the header, or any camera."""
    others = dict(raw.other_rates)
    if raw.t is not None and len(raw.t) > 1:
        step = float(np.nanmedian(np.diff(raw.t)))
        if step > 0.0:
            others["the column of time"] = 1.0 / step
    notes = [
        Note("clock", f"the rate is {raw.rate_hz:g} Hz, but {rate:.4g} Hz by {what}")
        for what, rate in others.items()
        if rate > 0.0 and abs(rate / raw.rate_hz - 1.0) > _SAME
    ]
    if not notes and raw.rate_hz < _SLOWEST_HZ:
        text = f"the rate is {raw.rate_hz:g} Hz, slower than any camera of a motion laboratory: it may be wrong"
        notes.append(Note("clock", text))
    return notes
