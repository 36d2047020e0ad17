"""A stream that is passed on as it comes."""

from collections.abc import Mapping

import numpy as np
import zmq

from arm.arm_file import format_arm
from arm.model import Arm
from limbcal.errors import ConfigError, ProtocolError
from playback.control_message import Request
from playback.playable import Frame
from protocol.message import FRAMES
from protocol.subscriber import Subscriber

#: What is passed on of a frame; the rest of a message is its sender's.
_FIELDS = ("frame0", "t0_ns", "dt_s", "n", "method", "q", "dq", "ddq", "tip", "points", "gap")


#: A frame's step of time [s]: stamps count ns, and whoever plots reckons in hundredths of a second.
_LEAST_STEP_S, _MOST_STEP_S = 1e-9, 3600.0


class LivePlayer:
    """Passes on the frames of a daemon, block by block, while it plays.

    Parameters
    ----------
    subscriber : Subscriber
        To `limb/frames`.
    endpoint : str
        Where they come from.
    arm : Arm
        The arm that moves.

    Attributes
    ----------
    refused : int
        Messages that were not as agreed.
    """

    finished = 0

    def __init__(self, subscriber: Subscriber, endpoint: str, arm: Arm) -> None:
        self.arm = arm
        self.name = f"live from {endpoint}"
        self.playing = True
        self.refused = 0
        self._subscriber = subscriber
        self._last: Frame = {}
        self._began_ns: int | None = None

    @property
    def waits_on(self) -> "zmq.Socket[bytes] | None":
        """The socket that brings frames."""
        return self._subscriber.socket

    def play(self) -> None:
        """Pass on what comes."""
        self.playing = True

    def deadline_s(self) -> None:
        """Return None: frames are due when they come."""
        return

    def take_due(self) -> Frame | None:
        """Return the fields of a block of frames that came; None where none did or nothing plays."""
        try:
            message = self._subscriber.receive(0)
        except ProtocolError:
            self.refused += 1
            return None
        if message is None or message[0] != FRAMES:
            return None
        fields = message[1]
        if not _is_agreed(fields, self.arm.n_joint):
            self.refused += 1
            return None
        if self._began_ns is None:
            self._began_ns = fields["t0_ns"]
        self._last = {
            **{name: fields[name] for name in _FIELDS},
            "source": self.name,
            "speed": 1.0,
            "trial": 0,
            "position_s": 1e-9 * (fields["t0_ns"] - self._began_ns),
        }
        return self._last if self.playing else None

    def prepare(self) -> None:
        """Do nothing: what comes is not known before."""

    def state(self) -> dict[str, object]:
        """Return the whole state, in plain values."""
        q = self._last.get("q")
        return {
            "playing": self.playing,
            "trial": 0,
            "position_s": self._last.get("position_s", 0.0),
            "duration_s": None,
            "rate_hz": None if not self._last else 1.0 / float(str(self._last["dt_s"])),
            "speed": 1.0,
            "loop": False,
            "source": self.name,
            "arm": self.arm.name,
            "twin": False,
            "live": True,
            "q": None if q is None else q[-1].tolist(),  # type: ignore[index]
            "trials": [],
            "finished": 0,
            "refused": self.refused,
            "missed": sum(self._subscriber.missed.values()),
        }

    def carry_out(self, request: Request) -> dict[str, object]:
        """Do what a request says; return what its reply has beside the state.

        Raises
        ------
        ConfigError
            If it asks for what is only there where a motion is stored.
        """
        match request.cmd:
            case "play":
                self.playing = True
            case "pause" | "stop":
                self.playing = False
            case "list":
                return {"trials": []}
            case "arm":
                return {"arm": format_arm(self.arm), "twin": None}
            case "state":
                pass
            case cmd:
                raise ConfigError(f"{cmd} is for a stored motion, and this is live: expected play, pause or state")
        return {}


def _is_agreed(fields: Mapping[str, object], n_joint: int) -> bool:
    """Say whether a block of frames has the fields and shapes of `limb/frames`."""
    n, dt_s = fields.get("n"), fields.get("dt_s")
    if any(type(fields.get(name)) is not int for name in ("frame0", "t0_ns")) or type(n) is not int or n < 1:
        return False
    if not isinstance(fields.get("method"), str) or not isinstance(fields.get("gap"), bool):
        return False
    if not (isinstance(dt_s, int | float) and _LEAST_STEP_S <= dt_s <= _MOST_STEP_S):
        return False
    values = {name: fields.get(name) for name in ("q", "dq", "ddq", "tip", "points")}
    shapes = {name: value.shape for name, value in values.items() if isinstance(value, np.ndarray)}
    if any(shapes.get(name) != (n, n_joint) for name in ("q", "dq", "ddq")) or shapes.get("tip") != (n, 3):
        return False
    points = shapes.get("points", ())
    return len(points) == 3 and (points[0], points[2]) == (n, 3)  # noqa: PLR2004 - block, sensors, axes
