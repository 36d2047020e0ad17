"""`limb/health`: once a second, how the daemon is doing."""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from daemon.device_clock import ClockState
from daemon.reception import Reception
from tracking.consistency import Consistency
from tracking.frames import Frames


@dataclass
class Latency:
    """How long the pipeline took, from the arrival of a block's last bytes to its publication."""

    seconds: list[float] = field(default_factory=list)

    def note(self, seconds: float) -> None:
        """Add one block."""
        self.seconds.append(seconds)

    def take(self) -> dict[str, float | None]:
        """Return median and 99th percentile [ms] since the last time, None where no block was published."""
        taken, self.seconds = self.seconds, []
        if not taken:
            return {"p50": None, "p99": None}
        p50, p99 = np.percentile(taken, [50, 99]) * 1e3
        return {"p50": float(p50), "p99": float(p99)}


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
    channel_names: Sequence[str],
    latency: Latency,
    delay: Delay,
    method: str,
    consistency: Consistency,
    connected: bool,
    recording: str | None,
    recording_lost: int,
    directory: str | None,
) -> dict[str, Any]:
    """Return the fields of `limb/health`; ``saturated`` and ``flat`` count samples by channel."""
    ledger, counters, watch, host = reception.ledger, reception.parser.counters, reception.watch, reception.host
    clock = ClockState(None, None, None) if reception.clock is None else reception.clock.state
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
        "strangers": reception.strangers,
        "gaps": {"causes": dict(ledger.causes), "last": [asdict(gap) for gap in ledger.gaps]},
        "saturated": dict(zip(channel_names, watch.saturated.tolist(), strict=True)),
        "flat": dict(zip(channel_names, watch.flat.tolist(), strict=True)),
        "clock_ppm": clock.ppm,
        "clock": {
            "ppm_std": clock.ppm_std,
            "error_ms": clock.error_ms,
            "host_ahead_s": 1e-9 * host.ahead_ns,
            "host_jumps": len(host.jumps),
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


def _free(directory: str | None) -> int | None:
    if directory is None:
        return None
    try:
        return shutil.disk_usage(directory).free
    except OSError:
        return None
