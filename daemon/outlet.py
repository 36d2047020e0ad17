"""Where the pipeline's results leave: to the subscribers, and the same bytes to the recorder."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from daemon.health import Delay
from daemon.motion_blocks import (
    RawSamples,
    bridge_blocks,
    frame_cutter,
    frames_message,
    plot_rows,
    raw_cutter,
    raw_message,
)
from daemon.record_link import RecordLink
from daemon.sample_ledger import Gap
from protocol.message import FRAMES, GAP, HEALTH, PLOT, RAW, TRIAL, encode
from protocol.publisher import Publisher
from tracking.frames import Frames, Phase


class Outlet:
    """Cuts motion and samples into blocks of 10 ms and sends them.

    Parameters
    ----------
    publisher : Publisher
    link : RecordLink or None
        None where nothing is recorded.
    arm_name, run, method : str
        What the messages carry.
    frame_dt_s, rate_hz : float
        Frame step and sample rate.
    publish_raw : bool
        Whether subscribers get `limb/raw`; the recorder always does.
    learning : int
        So many motions are for learning, those after them for evaluating.
    delay : Delay or None
        Takes note of every block of frames that came from samples; None where they are of long ago.
    """

    def __init__(
        self,
        publisher: Publisher,
        link: RecordLink | None,
        *,
        arm_name: str,
        run: str,
        method: str,
        frame_dt_s: float,
        rate_hz: float,
        publish_raw: bool,
        learning: int,
        delay: Delay | None,
    ) -> None:
        self._publisher = publisher
        self._link = link
        self._identity = {"arm": arm_name, "run": run}
        self._method = method
        self._frame_cutter = frame_cutter(frame_dt_s)
        self._raw_cutter = raw_cutter(rate_hz)
        self._publish_raw = publish_raw
        self._learning = learning
        self._delay = delay
        self._raw_seq = 0

    def send_raw(self, samples: RawSamples) -> None:
        """Take samples; send the blocks that they complete."""
        if self._publish_raw or self._link is not None:
            self._send_raw_blocks(self._raw_cutter.add(samples))

    def send_frames(self, frames: Sequence[Frames]) -> int:
        """Take frames; send the blocks that they complete and return how many those are."""
        blocks = [block for piece in frames for block in self._frame_cutter.add(piece)]
        self._send_frame_blocks(blocks)
        return len(blocks)

    def send_bridge(self, frames: Sequence[Frames]) -> None:
        """Take what a tracker gives out at a gap: frames before it, and then those that it predicted across it."""
        for piece in frames:
            if piece.gap:
                self._send_frame_blocks(self._frame_cutter.flush())
                self._send_frame_blocks(bridge_blocks(piece), predicted=True)
            else:
                self.send_frames([piece])
        self._send_frame_blocks(self._frame_cutter.flush())

    def send_phase(self, phase: Phase) -> None:
        """Send `limb/trial`, after the frames that led to it."""
        self._send_frame_blocks(self._frame_cutter.flush())
        role = "learn" if phase.trial <= self._learning else "evaluate"
        fields = {"trial": phase.trial, "t_ns": phase.t_ns, "state": phase.kind, "role": role}
        self._send(TRIAL, fields, phase.t_ns)

    def send_gap(self, gap: Gap) -> None:
        """Send `limb/gap`."""
        self._send(GAP, {**asdict(gap), "t_ns": max(gap.t_ns, 0)}, max(gap.t_ns, 0))

    def send_health(self, fields: Mapping[str, Any], t_ns: int) -> None:
        """Send `limb/health`."""
        self._send(HEALTH, fields, t_ns)

    def flush(self) -> None:
        """Send what did not fill a block."""
        self._send_raw_blocks(self._raw_cutter.flush())
        self._send_frame_blocks(self._frame_cutter.flush())

    def _send_frame_blocks(self, blocks: Sequence[Frames], predicted: bool = False) -> None:
        for block in blocks:
            if not predicted and self._delay is not None:
                self._delay.note(block, time.time_ns())
            self._send(FRAMES, frames_message(block, self._method), block.t0_ns)
            rows = plot_rows(block)
            if rows:
                self._send(PLOT, {"rows": rows}, block.t0_ns)

    def _send_raw_blocks(self, blocks: Sequence[RawSamples]) -> None:
        for block in blocks:
            if self._publish_raw:
                self._send(RAW, raw_message(block), block.t0_ns)
            elif self._link is not None:
                message = {**raw_message(block), **self._identity, "seq": self._raw_seq}
                self._raw_seq += 1
                self._link.write(encode(RAW, message), block.t0_ns)

    def _send(self, topic: str, fields: Mapping[str, Any], t_ns: int) -> None:
        parts = self._publisher.publish(topic, fields)
        if self._link is not None:
            self._link.write(parts, t_ns)
