"""Where the pipeline's results leave: to the subscribers, and the same bytes to the recorder."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

from daemon.monitoring.health import Delay
from daemon.publishing.motion_blocks import (
    Fields,
    RawSamples,
    bridge_blocks,
    frame_blocks,
    frames_message,
    raw_message,
)
from daemon.reception.sample_ledger import Gap
from daemon.recording.record_link import RecordLink
from protocol.message import FRAMES, GAP, HEALTH, PLOT, RAW, TRIAL, encode
from protocol.plot import plot_row_count, plot_rows, plot_step
from protocol.publisher import Publisher
from tracking.model.frames import Frames, Phase

#: Rows of `limb/plot` that are sent together: a twentieth of a second of them, which nobody sees on a screen.
_ROWS = 5


class Outlet:
    """Sends motion in blocks of 10 ms, samples, and what there is to say of them.

    Parameters
    ----------
    publisher : Publisher
    link : RecordLink or None
        None where nothing is recorded.
    arm_name, run, method : str
        What the messages carry.
    publish_raw : bool
        Whether subscribers get `limb/raw`; the recorder always does.
    learning : int
        Number of motions for learning; those after them are for evaluating.
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
        publish_raw: bool,
        learning: int,
        delay: Delay | None,
    ) -> None:
        self._publisher = publisher
        self._link = link
        self._identity = {"arm": arm_name, "run": run}
        self._method = method
        self._publish_raw = publish_raw
        self._learning = learning
        self._delay = delay
        self._raw_seq = 0
        self._plotted: list[Fields] = []  # frames of which rows of `limb/plot` are to be sent, and how many
        self._n_row = 0

    def send_raw(self, block: RawSamples) -> None:
        """Send `limb/raw`, or have it recorded where subscribers are not to get it."""
        if self._publish_raw:
            self._send(RAW, raw_message(block), block.t0_ns)
        elif self._link is not None:
            self._link.write(partial(self._encoded, block, self._raw_seq), block.t0_ns)
            self._raw_seq += 1

    def _encoded(self, block: RawSamples, seq: int) -> list[bytes]:
        """Return `limb/raw` for the recorder, which is in no hurry: many in a row cost less than each alone."""
        return encode(RAW, {**raw_message(block), **self._identity, "seq": seq})

    def send_frames(self, frames: Sequence[Frames]) -> int:
        """Send `limb/frames` and `limb/plot`; return how many blocks those are."""
        blocks = [block for piece in frames for block in frame_blocks(piece)]
        self._send_frame_blocks(blocks)
        return len(blocks)

    def send_bridge(self, frames: Sequence[Frames]) -> None:
        """Send what a tracker gives out at a gap: frames before it, and then those that it predicted across it."""
        for piece in frames:
            if piece.gap:
                self._send_frame_blocks(bridge_blocks(piece), predicted=True)
            else:
                self.send_frames([piece])

    def send_phase(self, phase: Phase) -> None:
        """Send `limb/trial`, after the frames that led to it."""
        self.flush()
        role = "learn" if phase.trial <= self._learning else "evaluate"
        fields = {"trial": phase.trial, "t_ns": phase.t_ns, "state": phase.kind, "role": role}
        self._send(TRIAL, {**fields, "last_seq": dict(self._publisher.last_seq)}, phase.t_ns)

    def send_gap(self, gap: Gap) -> None:
        """Send `limb/gap`."""
        self._send(GAP, {**asdict(gap), "t_ns": max(gap.t_ns, 0)}, max(gap.t_ns, 0))

    def send_health(self, fields: Mapping[str, Any], t_ns: int) -> None:
        """Send `limb/health`."""
        self._send(HEALTH, fields, t_ns)

    def flush(self) -> None:
        """Send the rows of `limb/plot` that wait for others."""
        plotted, self._plotted, self._n_row = self._plotted, [], 0
        if plotted:
            rows = [row for fields in plotted for row in plot_rows(fields, plot_step(fields["dt_s"]))]
            self._send(PLOT, {"rows": rows}, plotted[0]["t0_ns"])

    def _send_frame_blocks(self, blocks: Sequence[Frames], predicted: bool = False) -> None:
        for block in blocks:
            if not predicted and self._delay is not None:
                self._delay.note(block, time.time_ns())
            fields = frames_message(block, self._method)
            announced = self._publisher.last_seq.get(TRIAL)
            counted = {} if announced is None else {"last_seq": {TRIAL: announced}}
            self._send(FRAMES, {**fields, **counted}, block.t0_ns)
            if n_row := plot_row_count(block.frame0, block.n, block.dt_s):
                self._plotted.append(fields)
                self._n_row += n_row
                if self._n_row >= _ROWS:
                    self.flush()

    def _send(self, topic: str, fields: Mapping[str, Any], t_ns: int) -> None:
        parts = self._publisher.publish(topic, fields)
        if self._link is not None:
            self._link.write(parts, t_ns)
