"""What a server can play, stored or live."""

from collections.abc import Mapping
from typing import Protocol

import zmq

from arm.model import Arm
from playback.control_message import Request

Frame = dict[str, object]


class Playable(Protocol):
    """Gives frames when they are due and does what requests say."""

    @property
    def name(self) -> str:
        """What subscribers see as the source of the motion."""

    @property
    def arm(self) -> Arm:
        """The arm that moves."""

    @property
    def playing(self) -> bool:
        """Whether frames are due one after the other."""

    @property
    def finished(self) -> int:
        """How often a motion came to its end."""

    @property
    def waits_on(self) -> "zmq.Socket[bytes] | None":
        """A socket that brings frames; None where they are due by the clock."""

    def play(self) -> None:
        """Let frames come."""

    def deadline_s(self) -> float | None:
        """Return when the next frame is due on the monotonic clock, None where none is by the clock."""

    def take_due(self) -> Frame | None:
        """Return the fields of a frame that is due, or None while none is."""

    def prepare(self) -> None:
        """Use the time until the next frame is due."""

    def state(self) -> dict[str, object]:
        """Return the whole state, in plain values."""

    def carry_out(self, request: Request) -> Mapping[str, object]:
        """Do what a request says; return what its reply has beside the state.

        Raises
        ------
        LimbcalError
            If that cannot be done; nothing has changed then.
        """
