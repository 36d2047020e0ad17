"""`limb/health`: once a second, how the daemon is doing."""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from daemon.clock.device_clock import ClockState
from daemon.monitoring.alarms import still_axes
from daemon.reception.channel_watch import Reading
from daemon.reception.reception import Reception
from tracking.model.frames import Frames
from tracking.model.innovation_test import Consistency

#: Of the bins in which the latencies of a whole run are counted: a tenth of a millisecond to a minute.
_EDGES_S = np.geomspace(1e-4, 60.0, 673)


@dataclass
class Latency:
    """How long the pipeline took, from the arrival of a block's last bytes to its publication."""

    seconds: list[float] = field(default_factory=list)
    _counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(len(_EDGES_S) + 1, dtype=np.int64))

    def note(self, seconds: float) -> None:
        """Add one block."""
        self.seconds.append(seconds)

    def take(self) -> dict[str, float | None]:
        """Return percentiles [ms], None where no block was published.

        ``p50`` and ``p99`` are of the blocks since the last time, ``p99_run`` of all of them, rounded up by 2 %
        at the most.
        """
        taken, self.seconds = self.seconds, []
        np.add.at(self._counts, np.searchsorted(_EDGES_S, taken), 1)
        if not taken:
            return {"p50": None, "p99": None, "p99_run": self._run_p99()}
        p50, p99 = np.percentile(taken, [50, 99]) * 1e3
        return {"p50": float(p50), "p99": float(p99), "p99_run": self._run_p99()}

    def _run_p99(self) -> float | None:
        below = np.cumsum(self._counts)
        if not below[-1]:
            return None
        place = int(np.searchsorted(below, 0.99 * below[-1]))
        return 1e3 * float(_EDGES_S[min(place, len(_EDGES_S) - 1)])


@dataclass
class Delay:
    """How old frames are when they are published: the host's UTC then, less the frame's own time stamp.

    What a subscriber on this machine sees by the stamps, so whatever the device's clock has drifted from the
    host's since the first sample is in it.
    """

    frames: int = 0
    total_ns: float = 0.0
    most_ns: float = -np.inf

    def note(self, block: Frames, utc_ns: int) -> None:
        """Add a block that is published now."""
        first_ns = utc_ns - block.t0_ns
        self.frames += block.n
        self.total_ns += block.n * (first_ns - 0.5e9 * (block.n - 1) * block.dt_s)
        self.most_ns = max(self.most_ns, first_ns)

    def take(self) -> dict[str, float | None]:
        """Return mean and maximum [ms] over the frames since the last time, None where there were none."""
        frames, total_ns, most_ns = self.frames, self.total_ns, self.most_ns
        self.frames, self.total_ns, self.most_ns = 0, 0.0, -np.inf
        if frames == 0:
            return {"mean": None, "max": None}
        return {"mean": 1e-6 * total_ns / frames, "max": 1e-6 * most_ns}


def health_fields(
    *,
    uptime_s: float,
    last_seq: Mapping[str, int],
    reception: Reception,
    reading: Reading,
    q: Floats | None,
    q_units: Sequence[str],
    channel_names: Sequence[str],
    latency: Latency,
    delay: Delay,
    method: str,
    consistency: Consistency,
    connected: bool,
    recording: str | None,
    recording_lost: int,
    directory: str | None,
    n_rate: int = 0,
) -> dict[str, Any]:
    """Return the fields of `limb/health`; ``saturated`` and ``flat`` count samples by channel.

    Parameters
    ----------
    reading : Reading
        What channels read since the last report.
    q : (n_joint,) or None
        The last joint positions; None before there are any.
    q_units : sequence of str
        Of each joint, rad or m.
    n_rate : int
        How many channels, the last ones, are of gyroscopes.
    """
    ledger, counters, watch, host = reception.ledger, reception.parser.counters, reception.watch, reception.host
    clock = ClockState(None, None, None) if reception.clock is None else reception.clock.state
    rate, sensors = reception.rate, _sensors(channel_names[: len(channel_names) - n_rate], reading)
    return {
        "uptime_s": uptime_s,
        "device": asdict(reception.info),
        "last_seq": dict(last_seq),
        "samples": ledger.samples,
        "lost_samples": ledger.lost_samples,
        "crc_errors": counters.crc_errors,
        "resyncs": counters.resyncs,
        "reconnects": reception.reconnects,
        "doubled": reception.sequencer.doubled,
        "late": reception.sequencer.late,
        "strangers": reception.identity.strangers,
        "gaps": {"causes": dict(ledger.causes), "last": [asdict(gap) for gap in ledger.gaps]},
        "saturated": dict(zip(channel_names, watch.saturated.tolist(), strict=True)),
        "flat": dict(zip(channel_names, watch.flat.tolist(), strict=True)),
        "readings": {name: mean for name, mean, _ in sensors},
        "still": {name: still for name, _, still in sensors},
        "q": None if q is None else q.tolist(),
        "q_units": list(q_units),
        "rate_hz": rate.measured_hz,
        "rate": {"claimed_hz": rate.claimed_hz, "in_use_hz": rate.in_use_hz, "std_ppm": rate.std_ppm},
        "clock_ppm": clock.ppm,
        "clock": {
            "ppm_std": clock.ppm_std,
            "error_ms": reception.take_error_ms(),
            "host_ahead_s": 1e-9 * host.ahead_ns,
            "host_jumps": host.jumps,
        },
        "latency_ms": latency.take(),
        "delay_ms": delay.take(),
        "tracking": {
            "method": method,
            "innovation": consistency.size,
            "jolts": consistency.jolts,
            "doubted": consistency.doubted,
            "wrong": consistency.wrong,
        },
        "connected": connected,
        "recording": recording,
        "recording_lost": recording_lost,
        "disk_free_bytes": _free(directory),
    }


def _sensors(names: Sequence[str], reading: Reading) -> list[tuple[str, list[float] | None, bool]]:
    """Return each sensor's name, its mean reading [m/s^2] where there is one, and whether it was still."""
    return [
        (names[k][:-1], reading.mean[k : k + 3].tolist() if reading.samples else None, still_axes(reading, k))
        for k in range(0, len(names), 3)
    ]


def _free(directory: str | None) -> int | None:
    if directory is None:
        return None
    try:
        return shutil.disk_usage(directory).free
    except OSError:
        return None
