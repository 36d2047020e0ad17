"""What is wrong with forces recorded with markers, and whether anything loads a platform."""

import numpy as np

from limbcal.note import Note
from protocol.markers.missing import SHORTEST_S
from protocol.markers.recording import ForceRecord, runs

#: A channel changes if its range is as many times the noise from sample to sample.
_TIMES = 50.0


def nan_forces(records: tuple[ForceRecord, ...]) -> list[Note]:
    """Say where forces are NaN."""
    notes = []
    for record in records:
        bad = np.any(np.isnan(record.channels), axis=1)
        for first, last in runs(bad):
            if last - first >= SHORTEST_S * record.rate_hz:
                text = f"{record.name}: its forces are NaN for {(last - first) / record.rate_hz:.2f} s"
                times = first / record.rate_hz, last / record.rate_hz
                notes.append(Note("nan_forces", text, "", (record.name,), None, *times))
    return notes


def moves(record: ForceRecord) -> bool:
    """Say whether a platform's forces change beyond their noise."""
    for channel in record.channels.T:
        known = channel[np.isfinite(channel)]
        if len(known) > 2:
            noise = float(np.median(np.abs(np.diff(known, 2)))) / np.sqrt(6.0)
            low, high = np.quantile(known, [0.01, 0.99])
            if high - low > _TIMES * max(noise, np.finfo(np.float64).eps * max(abs(low), abs(high), 1.0)):
                return True
    return False
