"""From chunks of bytes to published motion: what the pipeline process does with what the reader brings."""

import time
from collections.abc import Sequence

from daemon.config import Setup
from daemon.health import Delay, Latency, health_fields
from daemon.motion_blocks import RawSamples
from daemon.outlet import Outlet
from daemon.reception import Reception
from daemon.record_link import RecordLink
from daemon.ring import Chunk
from daemon.warm_up import warm_up
from protocol.publisher import Publisher
from tracking.frames import Frames, Phase
from tracking.tracker import Tracker, consistency_of, tracker_of


class Pipeline:
    """Accounts for, tracks and sends out samples.

    Parameters
    ----------
    setup : Setup
    run : str
        UUID of this run.
    reception : Reception
    publisher : Publisher
    link : RecordLink or None
        None where nothing is recorded.

    Raises
    ------
    LimbcalError
        If the arm's sensors cannot be tracked by the configured method.
    """

    def __init__(
        self, setup: Setup, run: str, reception: Reception, publisher: Publisher, link: RecordLink | None
    ) -> None:
        rate_hz = reception.info.rate_hz
        warm_up(_tracker(setup, rate_hz), setup.arm, rate_hz, setup.initial_q_rad)
        self._tracker = _tracker(setup, rate_hz)
        self._delay = Delay()
        self._outlet = Outlet(
            publisher,
            link,
            arm_name=setup.arm.name,
            run=run,
            method=self._tracker.method,
            frame_dt_s=self._tracker.dt_s,
            rate_hz=rate_hz,
            publish_raw=setup.config.publish.raw,
            learning=setup.config.trials.learning,
            delay=self._delay,
        )
        self._reception = reception
        self._publisher = publisher
        self._link = link
        self._latency = Latency()
        self._dt_s = 1.0 / rate_hz
        self._names = [channel.name for channel in reception.info.channels]
        record = setup.config.record
        self._directory = None if record is None else record.directory
        self._began_s = time.monotonic()

    def accept(self, chunks: Sequence[Chunk]) -> None:
        """Take what arrived; send what it completes."""
        for run in self._reception.take(chunks):
            if run.lost:
                frames, phases = self._tracker.gap(run.lost)
                self._outlet.send_bridge(frames)
                self._send((), phases)
            self._outlet.send_raw(RawSamples(run.sample0, run.t0_ns, self._dt_s, run.a, run.lost > 0))
            if self._send(*self._tracker.push(run.t0_ns, run.a)):
                self._latency.note(1e-9 * (time.monotonic_ns() - chunks[-1].stamp_ns))

    def finish(self) -> None:
        """Send what waited for more samples or did not fill a block."""
        self._send(*self._tracker.flush())
        self._outlet.flush()

    def report(self, connected: bool) -> dict[str, object]:
        """Send `limb/health`; return what of it the person at the terminal wants to know."""
        if self._link is not None:
            self._link.check()
        fields = health_fields(
            uptime_s=time.monotonic() - self._began_s,
            last_seq=self._publisher.last_seq,
            ledger=self._reception.ledger,
            counters=self._reception.parser.counters,
            watch=self._reception.watch,
            channel_names=self._names,
            latency=self._latency,
            delay=self._delay,
            method=self._tracker.method,
            consistency=consistency_of(self._tracker),
            connected=connected,
            recording=None if self._link is None else self._link.recording,
            recording_lost=0 if self._link is None else self._link.lost,
            directory=self._directory,
        )
        self._outlet.send_health(fields, time.time_ns())
        counts = ("uptime_s", "samples", "lost_samples", "crc_errors", "recording", "recording_lost")
        return {key: fields[key] for key in (*counts, "latency_ms", "tracking")}

    def _send(self, frames: Sequence[Frames], phases: Sequence[Phase]) -> int:
        """Send what the tracker gave out; return how many blocks of frames that completed."""
        blocks = self._outlet.send_frames(frames)
        for phase in phases:
            self._outlet.send_phase(phase)
        return blocks


def _tracker(setup: Setup, rate_hz: float) -> Tracker:
    tracking, q0 = setup.config.tracking, setup.initial_q_rad
    zero = tracking.zero or "each-rest"
    return tracker_of(setup.arm, tracking.method, rate_hz, q0, tracking.frame_rate_hz, zero)
