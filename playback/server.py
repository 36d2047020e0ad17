"""The playing server: frames out on their deadlines, requests answered in between."""

import uuid
from collections.abc import Callable, Sequence
from types import TracebackType

import zmq

from limbcal.errors import LimbcalError
from limbcal.notify import notify
from playback.control_message import decode_request, encode_refusal, encode_reply
from playback.control_socket import ControlSocket
from playback.lateness import Lateness
from playback.playable import Playable
from playback.playhead import Clocks
from protocol.curve import Gate
from protocol.message import HEALTH, PLAY, PLOT
from protocol.plot import plot_rows, plot_step
from protocol.publisher import Publisher

#: Period of `limb/health` [s], see docs/protocol.md.
HEARTBEAT_S = 1.0
#: How soon replies are sent on that a client could not yet take [s].
_SEND_ON_S = 0.005


class Server:
    """Publishes what a player has due, and `limb/health` once a second.

    Parameters
    ----------
    context : zmq.Context
    player : Playable
    clocks : Clocks
    sleep : callable
        Waits a time [s]; needed for the rest of a wait below one millisecond.
    endpoint, control : str
        Where to bind the PUB and the ROUTER socket.
    gate : Gate, optional
        Lets in only whom it knows; needed where other machines can reach an endpoint.

    Raises
    ------
    DeviceError
        If an endpoint is taken or cannot be bound.
    ConfigError
        If an endpoint is not one.
    """

    def __init__(
        self,
        context: "zmq.Context[zmq.Socket[bytes]]",
        player: Playable,
        clocks: Clocks,
        sleep: Callable[[float], None],
        endpoint: str,
        control: str,
        gate: Gate | None = None,
    ) -> None:
        self.player = player
        self._clocks = clocks
        self._sleep = sleep
        self._run = str(uuid.uuid4())
        self._publisher = Publisher(context, endpoint, player.arm.name, self._run, gate, watched=True)
        try:
            self._control = ControlSocket(context, control, self.answer, gate)
        except BaseException:
            self._publisher.close()
            raise
        self._poller = zmq.Poller()
        for socket in (self._control.socket, self._publisher.socket, player.waits_on):
            if socket is not None:
                self._poller.register(socket, zmq.POLLIN)
        self._lateness = Lateness()
        self._start_s = clocks.monotonic()
        self._heartbeats = 0

    @property
    def endpoint(self) -> str:
        """Where frames are published."""
        return self._publisher.endpoint

    @property
    def control(self) -> str:
        """Where requests are taken."""
        return self._control.endpoint

    def serve(self, once: bool = False) -> None:
        """Serve for ever, or until a trial has been played to its end."""
        self.step()
        while not (once and self.player.finished):
            self._wait()
            self.step()

    def step(self) -> None:
        """Send what is due: at most one frame and one heartbeat."""
        deadline_s = self.player.deadline_s()
        frame = self.player.take_due()
        if frame is not None:
            self._publisher.publish(PLAY, frame)
            if deadline_s is not None:
                self._lateness.add(self._clocks.monotonic() - deadline_s)
            rows = plot_rows(frame, plot_step(float(str(frame["dt_s"]))))
            if rows:
                self._publisher.publish(PLOT, {"rows": rows})
            self.player.prepare()
        uptime_s = self._clocks.monotonic() - self._start_s
        joined = self._publisher.joined()  # whoever comes late hears the state at once
        beats = uptime_s >= self._heartbeats * HEARTBEAT_S
        if joined or beats:
            self._publisher.publish(HEALTH, self._health(uptime_s))
        if beats:
            notify(WATCHDOG=1)
            self._heartbeats = int(uptime_s / HEARTBEAT_S) + 1  # after a hold-up one is enough

    def state(self) -> dict[str, object]:
        """Return the player's state, where it is sent to and how late it is."""
        return {
            **self.player.state(),
            "lateness_ms": self._lateness.summary_ms(),
            "endpoint": self.endpoint,
            "run": self._run,
        }

    def answer(self, parts: Sequence[bytes]) -> bytes:
        """Carry out a request and return the reply; a bad one is refused in one sentence."""
        try:
            request = decode_request(parts)
            more = self.player.carry_out(request)
        except LimbcalError as error:
            return encode_refusal(str(error))
        return encode_reply(self.state(), **more)

    def _health(self, uptime_s: float) -> dict[str, object]:
        return {
            "uptime_s": uptime_s,
            "last_seq": dict(self._publisher.last_seq),
            "playing": self.player.playing,
            "lateness_ms": self._lateness.summary_ms(),
            "unheard": self._control.unheard,
            "state": self.player.state(),
        }

    def _wait(self) -> None:
        """Wait for the next deadline, or until a request, a subscriber or a live frame comes."""
        until_s = self._start_s + self._heartbeats * HEARTBEAT_S
        if (frame_s := self.player.deadline_s()) is not None:
            until_s = min(until_s, frame_s)
        if self._control.keeps:
            until_s = min(until_s, self._clocks.monotonic() + _SEND_ON_S)
        whole_ms = int(max(0.0, until_s - self._clocks.monotonic()) * 1e3)
        came = dict(self._poller.poll(whole_ms))  # ZeroMQ waits whole milliseconds only
        if self._control.keeps or self._control.socket in came:
            self._control.serve()
        if not came:
            self._sleep(max(0.0, until_s - self._clocks.monotonic()))

    def close(self) -> None:
        """Let what was sent last leave, and free both endpoints."""
        self._control.close()
        self._publisher.close()

    def __enter__(self) -> "Server":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
