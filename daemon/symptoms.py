"""What a report shows that may be wrong; `alarms` decides whether it is."""

from collections.abc import Mapping, Sequence
from typing import Any

from daemon.alarms import wrong_channels
from daemon.reception import Reception

#: A device clock further off than this is worth a word [ppm].
_FAR_OFF_PPM = 500.0
#: So many standard errors are taken off before it is.
_SURELY = 3.0
#: A host's clock that is so far from where the run's goes on, after it was set, is worth a word, too [s].
_SET_S = 0.05
#: Samples lost in a second: this share of them.
_LOSSES = 1e-3
#: Frames that are published so much later than their bytes came are late [ms].
_BEHIND_MS = 200.0
#: The disk is nearly full if less than so many times is free than what stops the recording.
_NEARLY = 10.0


class Symptoms:
    """Compares each report with the one before.

    Parameters
    ----------
    reception : Reception
    names : sequence of str
        Of the channels.
    free_bytes : int
        Where recording pauses.
    """

    def __init__(self, reception: Reception, names: Sequence[str], free_bytes: int) -> None:
        self._reception, self._names, self._free_bytes = reception, names, free_bytes
        self._lost = self._frames = self._discarded = 0

    def look(self, health: Mapping[str, Any], records: bool) -> dict[tuple[str, str], str]:
        """Return what is wrong, by alarm and subject.

        Parameters
        ----------
        health : mapping
            The fields of `limb/health`.
        records : bool
            Whether a recording was asked for.
        """
        reception = self._reception
        reading = reception.watch.take()
        wrong = wrong_channels(self._names, reading)
        lost = reception.ledger.lost_samples - self._lost
        counters = reception.parser.counters
        frames, discarded = counters.frames - self._frames, counters.discarded_bytes - self._discarded
        self._lost, self._frames = reception.ledger.lost_samples, counters.frames
        self._discarded = counters.discarded_bytes
        if not health["connected"]:
            wrong["disconnected", ""] = "there is no device"
        if reception.stranger is not None:
            wrong["stranger", ""] = f"found {reception.stranger}, expected {reception.info.serial}"
        if discarded and not frames:
            wrong["garbage", ""] = f"{discarded} bytes and no frame in the last second"
        if lost > _LOSSES * max(reading.samples, 1):
            wrong["losses", ""] = f"{lost} samples in the last second"
        p99 = health["latency_ms"]["p99"]
        if p99 is not None and p99 > _BEHIND_MS:
            wrong["behind", ""] = f"a block in a hundred takes {p99:.0f} ms and more"
        if health["tracking"]["wrong"]:
            wrong["contradiction", ""] = "the tracker's claims are broken too often"
        ppm, ahead_s = health["clock_ppm"], health["clock"]["host_ahead_s"]
        if ppm is not None and abs(ppm) - _SURELY * health["clock"]["ppm_std"] > _FAR_OFF_PPM:
            wrong["clock", "device"] = f"it is {ppm:+.0f} ppm off"
        if abs(ahead_s) > _SET_S:
            wrong["clock", "host"] = f"it was set by {ahead_s:+.1f} s in all"
        free = health["disk_free_bytes"]
        if records and health["recording"] is None:
            wrong["not recorded", ""] = "nothing is recorded"
        elif free is not None and free < _NEARLY * self._free_bytes:
            wrong["disk", ""] = f"{free / 1e6:.0f} MB are left"
        return wrong
