"""What a stream was to bring: motions that were made, and the time of frames that are missing."""

from collections.abc import Mapping
from typing import Any

from protocol.message import FRAMES, HEALTH, TRIAL


class StreamAccount:
    """Keeps count of a daemon's messages, each given once and in order.

    Attributes
    ----------
    frames : int
        Frames received.
    moving : bool
        Whether a motion is under way.
    rested_s : float
        For how long the arm has been at rest since its last motion, by the frames' own time; 0 before the first.
    """

    def __init__(self) -> None:
        self.frames = 0
        self.moving = False
        self.rested_s = 0.0
        self._before_made = 0  # of the runs before this one
        self._before_lost_s = 0.0
        self._begin_anew(None)

    def _begin_anew(self, run: object) -> None:
        self._run = run
        self._made = 0
        self._frame = self._seq = 0  # the next ones
        self._missed_s = self._hole_s = self._device_s = 0.0
        self._tail, self._block_s = 0, 0.0
        self.moving = False

    @property
    def made(self) -> int:
        """Motions that have ended, whether they came or not."""
        return self._before_made + self._made

    @property
    def lost_s(self) -> float:
        """Time of the frames that were missed, and of the samples that the device or its line lost [s]."""
        of_run = self._missed_s + self._tail * self._block_s + max(self._hole_s, self._device_s)
        return self._before_lost_s + of_run

    def take(self, topic: str, fields: Mapping[str, Any]) -> None:
        """Take in a message; fields that are missing or of another kind count for nothing."""
        if fields.get("run") != self._run:
            self._before_made, self._before_lost_s = self.made, self.lost_s
            self._begin_anew(fields.get("run"))
        if topic == FRAMES:
            self._take_frames(fields)
        elif topic == TRIAL:
            self._take_trial(fields)
        elif topic == HEALTH:
            self._take_health(fields)

    def _take_frames(self, fields: Mapping[str, Any]) -> None:
        n, frame0, dt_s = fields.get("n"), fields.get("frame0"), fields.get("dt_s")
        if not isinstance(n, int) or not isinstance(frame0, int) or not isinstance(dt_s, float):
            return
        seq = fields.get("seq")
        hole_s = dt_s * max(frame0 - self._frame, 0)
        if isinstance(seq, int) and seq > self._seq:
            self._missed_s += hole_s
        else:
            self._hole_s += hole_s
        self._seq = seq + 1 if isinstance(seq, int) else 0
        self._frame, self._tail, self._block_s = frame0 + n, 0, n * dt_s
        self.frames += n
        if not self.moving and self.made:
            self.rested_s += self._block_s

    def _take_trial(self, fields: Mapping[str, Any]) -> None:
        trial, state = fields.get("trial"), fields.get("state")
        if not isinstance(trial, int):
            return
        self.moving = state == "begin"
        self._made = max(self._made, trial if state == "end" else trial - 1)
        self.rested_s = 0.0

    def _take_health(self, fields: Mapping[str, Any]) -> None:
        """Learn of what never came: a motion is announced twice, when it begins and when it ends."""
        last, lost, device = fields.get("last_seq"), fields.get("lost_samples"), fields.get("device")
        if isinstance(last, dict):
            if isinstance(last.get(TRIAL), int):
                self._made = max(self._made, (last[TRIAL] + 1) // 2)
            if isinstance(last.get(FRAMES), int):
                self._tail = max(last[FRAMES] + 1 - self._seq, 0)
        rate_hz = device.get("rate_hz") if isinstance(device, dict) else None
        if isinstance(lost, int) and isinstance(rate_hz, float) and rate_hz > 0.0:
            self._device_s = lost / rate_hz
