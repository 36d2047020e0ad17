"""From chunks of bytes to published motion: what the pipeline process does with what the reader brings."""

import time
from collections.abc import Sequence

from arm.model import Floats
from daemon.acquisition.ring import Chunk
from daemon.config.config import Setup
from daemon.monitoring.alarm_conditions import AlarmConditions
from daemon.monitoring.alarms import Alarms
from daemon.monitoring.health import Delay, Latency, health_fields
from daemon.pipeline.warm_up import warm_up
from daemon.publishing.motion_blocks import RawSamples, unbroken
from daemon.publishing.outlet import Outlet
from daemon.publishing.sample_blocks import SampleBlocks
from daemon.reception.reception import Reception
from daemon.reception.sample_ledger import Gap
from daemon.reception.sample_runs import Run
from daemon.recording.record_link import RecordLink
from protocol.publisher import Publisher
from tracking.model.frames import Frames, Phase
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
        warm_up(tracker_for(setup, rate_hz), setup.arm, rate_hz, setup.initial_q_rad)
        self._setup = setup
        self._tracker = tracker_for(setup, rate_hz)
        self._dt_s = 1.0 / rate_hz
        self._waiting: list[Run] | None = []  # until the rate is known
        self._delay = Delay()
        self._outlet = Outlet(
            publisher,
            link,
            arm_name=setup.arm.name,
            run=run,
            method=self._tracker.method,
            publish_raw=setup.config.publish.raw,
            learning=setup.config.trials.learning,
            delay=self._delay if setup.replay is None else None,
        )
        self._reception = reception
        self._publisher = publisher
        self._link = link
        self._latency = Latency()
        self._blocks = SampleBlocks(rate_hz)
        self._names = [channel.name for channel in reception.info.channels]
        record = setup.config.record
        self._directory = None if record is None else record.directory
        free_bytes = 0.0 if record is None else record.free_bytes
        self._n_rate = 3 * len(setup.arm.gyroscopes)
        self._conditions = AlarmConditions(reception, self._names, free_bytes, self._n_rate)
        self._alarms = Alarms()
        self._dropped = 0
        self._frames_sent = False
        self._q: Floats | None = None
        self._q_units = ["m" if joint.type == "prismatic" else "rad" for joint in setup.arm.joints]
        self._began_s = time.monotonic()

    @property
    def awaits_info(self) -> bool:
        """Whether the device must say again what it is."""
        return self._reception.awaits_info

    @property
    def streaming(self) -> bool:
        """Whether there is a device, and frames of its samples have been sent."""
        return self._reception.connected and self._frames_sent

    def accept(self, chunks: Sequence[Chunk], dropped: int = 0) -> None:
        """Take what arrived, if anything; send what it completes.

        Parameters
        ----------
        chunks : sequence of Chunk
        dropped : int
            Chunks so far for which there was no room.
        """
        if dropped > self._dropped:
            self._dropped = dropped
            self._reception.dropped()
        arrived_ns = chunks[-1].stamp_ns if chunks else None
        runs: Sequence[Run] = self._reception.take(chunks)
        if self._waiting is not None:
            self._waiting += runs
            runs = self._begin() if self._reception.knows_rate(time.monotonic_ns()) else []
        self._follow(runs, arrived_ns)

    def _begin(self) -> Sequence[Run]:
        """Begin to track by the rate that is known now; return the samples that waited for it."""
        waiting, self._waiting = self._waiting or [], None
        first = next((times for run in waiting for times in run.times), None)
        if first is not None:
            self._dt_s = first.steps.dt_s(first.ticks[0])
        rate_hz = 1.0 / self._dt_s
        self._tracker = tracker_for(self._setup, rate_hz)
        self._blocks = SampleBlocks(rate_hz)
        return waiting

    def _follow(self, runs: Sequence[Run], arrived_ns: int | None) -> None:
        for run in runs:
            self._track(self._blocks.add(run), arrived_ns)
        for gap in self._reception.new_gaps():
            self._outlet.send_gap(gap)
        if self._link is not None:
            self._link.poll()

    def finish(self) -> None:
        """Send what waited for more samples or did not fill a block."""
        runs = self._reception.finish()
        self._follow(runs if self._waiting is None else [*self._begin(), *runs], None)
        self._track(self._blocks.flush(), None)
        self._send(*self._tracker.flush())
        self._outlet.flush()
        if self._link is not None:
            self._link.flush()

    def report(self, connected: bool) -> dict[str, object]:
        """Send `limb/health`; return it, and words for the person at the terminal."""
        self._outlet.flush()  # `last_seq` counts what it sends
        if self._link is not None:
            self._link.check()
        jump = self._reception.host.look()
        if jump is not None:
            cause, ledger = "the host's clock was set", self._reception.ledger
            gap = Gap(ledger.position, 0, jump.t_ns, f"{cause} by {1e-9 * jump.by_ns:+.3f} s", True)
            ledger.note(gap, cause)
            self._outlet.send_gap(gap)
        reading = self._reception.watch.take()
        fields = health_fields(
            uptime_s=time.monotonic() - self._began_s,
            last_seq=self._publisher.last_seq,
            reception=self._reception,
            reading=reading,
            q=self._q,
            q_units=self._q_units,
            channel_names=self._names,
            latency=self._latency,
            delay=self._delay,
            method=self._tracker.method,
            consistency=consistency_of(self._tracker),
            connected=connected and self._reception.connected,
            recording=None if self._link is None else self._link.recording,
            recording_lost=0 if self._link is None else self._link.lost,
            directory=self._directory,
            n_rate=self._n_rate,
        )
        now_ns = time.monotonic_ns() + self._reception.host.offset_ns
        removed = 0 if self._link is None else self._link.removed
        wrong = self._conditions.look(fields, reading, self._link is not None, removed)
        begun, ended = self._alarms.report(wrong, now_ns)
        fields["alarms"] = [alarm.document() for alarm in self._alarms.raised.values()]
        self._outlet.send_health(fields, now_ns)
        words = [
            *(f"alarm: {one.sentence}" for one in begun),
            *(f"over: {one.name} {one.subject}" for one in ended),
        ]
        return {**fields, "words": words}

    def _track(self, blocks: Sequence[RawSamples], arrived_ns: int | None) -> None:
        """Send samples and what the tracker makes of them, at once of all between which nothing changes."""
        for together in unbroken(blocks):
            first = together[0]
            if first.lost:
                frames, phases = self._tracker.gap(first.lost)
                self._outlet.send_bridge(frames)
                self._send((), phases)
            if first.dt_s != self._dt_s:
                self._dt_s = first.dt_s
                self._tracker.retime(1.0 / first.dt_s)
            motion = self._tracker.push_all([(block.t0_ns, block.a) for block in together])
            for block, (frames, phases) in zip(together, motion, strict=True):
                self._outlet.send_raw(block)
                if self._send(frames, phases) and arrived_ns is not None:
                    self._latency.note(1e-9 * (time.monotonic_ns() - arrived_ns))

    def _send(self, frames: Sequence[Frames], phases: Sequence[Phase]) -> int:
        """Send what the tracker gave out; return how many blocks of frames that completed."""
        blocks = self._outlet.send_frames(frames)
        self._frames_sent = self._frames_sent or blocks > 0
        if blocks:
            self._q = frames[-1].q[-1]
        for phase in phases:
            self._outlet.send_phase(phase)
        return blocks


def tracker_for(setup: Setup, rate_hz: float) -> Tracker:
    """Return the tracker of a setup, for samples at some rate.

    Raises
    ------
    ConfigError
        If the arm's sensors cannot be tracked by the configured method.
    """
    tracking, q0 = setup.config.tracking, setup.initial_q_rad
    zero = tracking.zero or "each-rest"
    return tracker_of(setup.arm, tracking.method, rate_hz, q0, tracking.frame_rate_hz, zero)
