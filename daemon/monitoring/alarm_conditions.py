"""What a report shows that may be wrong; `alarms` decides whether it is."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from daemon.monitoring.alarms import wrong_channels
from daemon.reception.channel_watch import Reading
from daemon.reception.reception import Reception
from limbcal.digits import NORMAL_95

#: No crystal is further off than this over its life, so a rate or a clock that is is reported [ppm].
_FAR_OFF_PPM = 500.0
#: Standard errors that are taken off before it is: by chance in 0.1 % of reports.
_STANDARD_ERRORS = 3.0
#: A host's clock that is so far from where the run's goes on, after it was set, is reported, too [s]: it is
#: what `daemon.clock.host_clock` takes for setting it.
_SET_S = 0.05
#: Fraction of a second's samples that may be lost without an alarm: a convention.
_LOSS_FRACTION = 1e-3
#: Reports that show an error of the device's clock after it happened: enough to raise an alarm.
_REPORTS = 3
#: Time from bytes to published frames above which frames are late [ms]: a convention.
_BEHIND_MS = 200.0
#: The disk is nearly full if less than this many times what stops the recording is free [1]: a convention.
_NEARLY_FULL = 10.0


class AlarmConditions:
    """Compares each report with the one before.

    Parameters
    ----------
    reception : Reception
    names : sequence of str
        Of the channels.
    free_bytes : float
        Where recording pauses.
    n_rate : int
        How many channels, the last ones, are of gyroscopes.
    """

    def __init__(self, reception: Reception, names: Sequence[str], free_bytes: float, n_rate: int = 0) -> None:
        self._reception, self._names, self._free_bytes, self._n_rate = reception, names, free_bytes, n_rate
        self._lost = self._frames = self._discarded = self._malformed = 0
        self._clock_errors = self._clock_off = 0

    def look(
        self, health: Mapping[str, Any], reading: Reading, records: bool, removed: int = 0
    ) -> dict[tuple[str, str], str]:
        """Return what is wrong, by alarm and subject.

        Parameters
        ----------
        health : mapping
            The fields of `limb/health`.
        reading : Reading
            What channels read since the last report.
        records : bool
            Whether a recording was asked for.
        removed : int
            Files of the recording that somebody took away while they were written.
        """
        reception = self._reception
        wrong = wrong_channels(self._names, reading, self._n_rate)
        lost = reception.ledger.lost_samples - self._lost
        counters = reception.parser.counters
        frames, discarded = counters.frames - self._frames, counters.discarded_bytes - self._discarded
        self._lost, self._frames = reception.ledger.lost_samples, counters.frames
        malformed, self._malformed = counters.malformed - self._malformed, counters.malformed
        self._discarded = counters.discarded_bytes
        if not health["connected"]:
            wrong["disconnected", ""] = "there is no device"
        if reception.identity.stranger is not None:
            wrong["stranger", ""] = f"found {reception.identity.stranger}, expected {reception.info.serial}"
        if discarded and not frames:
            wrong["garbage", ""] = f"{discarded} bytes and no frame in the last second"
        if malformed:
            wrong["nonsense", ""] = f"{malformed} in the last second, at last {reception.parser.last_error}"
        if lost > _LOSS_FRACTION * max(reading.samples, 1):
            wrong["losses", ""] = f"{lost} samples in the last second"
        p99 = health["latency_ms"]["p99"]
        if p99 is not None and p99 > _BEHIND_MS:
            wrong["behind", ""] = f"a block in a hundred takes {p99:.0f} ms and more"
        if health["tracking"]["wrong"]:
            wrong["contradiction", ""] = "the tracker's claims are broken too often"
        if (off := _rate_off(health)) is not None:
            wrong["rate", ""] = off
        wrong |= self._clocks(health["clock"]["host_ahead_s"])
        free = health["disk_free_bytes"]
        if records and health["recording"] is None:
            wrong["not recorded", ""] = "nothing is recorded"
        elif free is not None and free < _NEARLY_FULL * self._free_bytes:
            wrong["disk", ""] = f"{free / 1e6:.0f} MB are left"
        if removed:
            wrong["removed", ""] = f"{removed} so far while written, with what was in them"
        return wrong

    def _clocks(self, ahead_s: float) -> dict[tuple[str, str], str]:
        """Return what was wrong with the device's clock of late, and whether the host's was set."""
        wrong: dict[tuple[str, str], str] = {}
        guard = self._reception.guard
        errors, self._clock_errors = guard.errors - self._clock_errors, guard.errors
        self._clock_off = _REPORTS if errors or guard.is_off else max(self._clock_off - 1, 0)
        if guard.is_off:
            wrong["clock", "device"] = "it stands still or shows anything"
        elif self._clock_off:
            wrong["clock", "device"] = f"it was off {guard.errors} times in all"
        if abs(ahead_s) > _SET_S:
            wrong["clock", "host"] = f"it was set by {ahead_s:+.1f} s in all"
        return wrong


def _rate_off(health: Mapping[str, Any]) -> str | None:
    """Return how a device's rate is not what its INFO says, or its clock not what this machine's is."""
    rate, clock, found = health["rate"], health["clock"], []
    claimed_hz, measured_hz = rate["claimed_hz"], health["rate_hz"]
    if measured_hz is not None:
        ppm = 1e6 * (measured_hz / claimed_hz - 1.0)
        if _far(ppm, rate["std_ppm"]):
            half_hz = NORMAL_95 * 1e-6 * rate["std_ppm"] * measured_hz
            digits = max(0, -math.floor(math.log10(half_hz))) if half_hz > 0.0 else 6
            said = f"it samples at {measured_hz:.{digits}f} ± {half_hz:.{digits}f} Hz"
            found.append(f"{said}, {_off(ppm)} than the {claimed_hz:g} Hz of its INFO")
    ppm = health["clock_ppm"]
    if ppm is not None and _far(ppm, clock["ppm_std"]):
        found.append(f"its clock is {_off(ppm)} than this machine's")
    return "; ".join(found) or None


def _far(ppm: float, std_ppm: float) -> bool:
    return abs(ppm) - _STANDARD_ERRORS * std_ppm > _FAR_OFF_PPM


def _off(ppm: float) -> str:
    return f"{abs(ppm) / 1e4:.2f} % {'faster' if ppm > 0.0 else 'slower'}"
