"""What a page shows: the newest frame of a stream, and the stretch of motion behind it."""

import threading
import time
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import zmq

from limbcal.errors import ProtocolError
from playback.trajectory import Floats
from protocol.curve import ClientKey
from protocol.message import FRAMES, PLAY
from protocol.subscriber import Subscriber

#: How long the thread waits for a message before it looks whether it is to end [ms].
POLL_MS = 50
#: Rows kept behind the newest, and how close they may follow each other [s]: twenty seconds at 100 Hz.
HISTORY, SPACING_S = 2000, 0.0099
#: A place this far from where the last frame led is no motion but a jump [s].
JUMP_S = 0.3


@dataclass(frozen=True)
class Pose:
    """One arm at one instant: joints, (n_joint,) [rad or m], and tip, (3,) [m]."""

    q: Floats
    tip: Floats


@dataclass(frozen=True)
class Row:
    """One frame: the arm, its twin where there is one, and its place in the motion [s]."""

    position_s: float
    real: Pose
    twin: Pose | None


@dataclass(frozen=True)
class Picture:
    """The newest frame and where it is from.

    Attributes
    ----------
    count : int
        Messages heard so far; another number is another picture.
    jumps : int
        How often the motion was broken off, by a seek or another trial: what was before is not its past.
    heard_s : float
        When it came, on the monotonic clock.
    """

    count: int
    jumps: int
    heard_s: float
    row: Row
    topic: str
    source: str
    speed: float
    fields: Mapping[str, Any]


class Feed:
    """Follows `limb/play` or `limb/frames` from a thread of its own and keeps the newest only.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
    key : ClientKey, optional
        Where the publisher lets in only whom it knows.

    Raises
    ------
    ConfigError
        If the endpoint is not one.
    """

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, key: ClientKey | None = None
    ) -> None:
        self.endpoint = endpoint
        self.broken = 0  # messages that were none
        self._subscriber = Subscriber(context, endpoint, [PLAY, FRAMES], key, watched=True)
        self._lock = threading.Lock()
        self._picture: Picture | None = None
        self._rows: deque[Row] = deque(maxlen=HISTORY)
        self._begin_ns: int | None = None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._follow, name="feed")
        self._thread.start()

    def newest(self) -> Picture | None:
        """Return the newest picture, None as long as nothing was heard."""
        return self._picture

    def history(self, span_s: float) -> list[Row]:
        """Return the frames of the last seconds of the motion, oldest first."""
        with self._lock:
            rows = list(self._rows)
        return [row for row in rows if row.position_s >= rows[-1].position_s - span_s]

    def close(self) -> None:
        """End the thread and free the socket."""
        self._over.set()
        self._thread.join()
        self._subscriber.close()

    def _follow(self) -> None:
        while not self._over.is_set():
            try:
                message = self._subscriber.receive(POLL_MS)
                if message is not None:
                    self._take(*message)
            except (ProtocolError, KeyError, TypeError, ValueError, IndexError):
                self.broken += 1  # somebody else's mistake must not end the page

    def _take(self, topic: str, fields: Mapping[str, Any]) -> None:
        rows = _rows(fields, self._begin(topic, fields))
        last = self._picture
        jumped = last is not None and (
            last.fields.get("trial") != fields.get("trial")
            or not -SPACING_S < rows[0].position_s - last.row.position_s < JUMP_S * max(1.0, last.speed)
            or len(rows[0].real.q) != len(last.row.real.q)
        )
        with self._lock:
            if jumped:
                self._rows.clear()
            for row in rows:
                if not self._rows or row.position_s - self._rows[-1].position_s >= SPACING_S:
                    self._rows.append(row)
        self._picture = Picture(
            count=1 if last is None else last.count + 1,
            jumps=int(jumped) + (0 if last is None else last.jumps),
            heard_s=time.monotonic(),
            row=rows[-1],
            topic=topic,
            source=str(fields.get("source", fields.get("method", ""))),
            speed=float(fields.get("speed", 1.0)),
            fields=fields,
        )

    def _begin(self, topic: str, fields: Mapping[str, Any]) -> float:
        """Return the place of a message's first frame; what is live has no other than the time since it began."""
        if "position_s" in fields:
            return float(fields["position_s"])
        if topic == PLAY:
            return float(fields["frame0"]) * float(fields["dt_s"])
        if self._begin_ns is None or fields["t0_ns"] < self._begin_ns:
            self._begin_ns = int(fields["t0_ns"])
        return (int(fields["t0_ns"]) - self._begin_ns) * 1e-9


def _rows(fields: Mapping[str, Any], begin_s: float) -> list[Row]:
    twin = fields.get("twin")
    real, dt_s = _poses(fields), float(fields["dt_s"]) * float(fields.get("speed", 1.0))
    virtual: list[Pose | None] = [None] * len(real) if not isinstance(twin, Mapping) else [*_poses(twin)]
    return [
        Row(begin_s + k * dt_s, pose, other) for k, (pose, other) in enumerate(zip(real, virtual, strict=True))
    ]


def _poses(fields: Mapping[str, Any]) -> list[Pose]:
    q, tip = np.asarray(fields["q"], dtype=float), np.asarray(fields["tip"], dtype=float)
    if (
        q.ndim != 2
        or not len(q)
        or tip.shape != (len(q), 3)
        or not (np.isfinite(q).all() and np.isfinite(tip).all())
    ):
        raise ValueError(f"q of shape {q.shape} and tip of shape {tip.shape}")
    return [Pose(*row) for row in zip(q, tip, strict=True)]
