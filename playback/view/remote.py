"""The page's line to the control socket of a playback."""

import threading
import time
from collections.abc import Mapping
from typing import Any

import numpy as np
import zmq

from limbcal.errors import ProtocolError
from playback.control_message import Request, Value, decode_reply, encode_request
from playback.trajectory import Floats
from protocol.binding import connect
from protocol.curve import ClientKey
from protocol.parts import MESSAGE_BYTES, receive_parts

#: How often the state is asked for while nobody wants anything else [s].
STATE_S = 0.2
#: When an answer is given up [s].
PATIENCE_S = 3.0


class Motion:
    """A whole trial's angles, thinned out: what the time line draws.

    Attributes
    ----------
    t : (k,) [s]
    q, twin_q : (k, n_joint) [rad or m]
        ``twin_q`` is None where there is no twin.
    tip, twin_tip : (k, 3) [m]
    """

    def __init__(self, fields: Mapping[str, Any]) -> None:
        self.t: Floats = np.asarray(fields["t"], dtype=float)
        self.q: Floats = np.asarray(fields["q"], dtype=float)
        self.tip: Floats = np.asarray(fields["tip"], dtype=float)
        self.twin_q = _or_none(fields.get("twin_q"))
        self.twin_tip = _or_none(fields.get("twin_tip"))


def _or_none(values: object) -> Floats | None:
    return None if values is None else np.asarray(values, dtype=float)


class Remote:
    """Asks a playback for what its page wants, from a thread of its own, and keeps its newest state.

    What is wanted twice before it was asked for is asked for once: of many seeks only the last counts.

    Parameters
    ----------
    context : zmq.Context
    endpoint : str
        The control endpoint; a playback that comes up later is found.
    key : ClientKey, optional

    Attributes
    ----------
    state : mapping or None
        The newest state, None while nobody answers.
    motion : Motion or None
        The angles of the trial that is loaded.
    refusal : str
        What the last refused wish was refused with, empty after one that was carried out.
    arms : tuple of str and (str or None), or None
        TOML text of the arm and of its twin.

    Raises
    ------
    ConfigError
        If the endpoint is not one.
    """

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, key: ClientKey | None = None
    ) -> None:
        self.endpoint = endpoint
        self.state: Mapping[str, Any] | None = None
        self.motion: Motion | None = None
        self.refusal = ""
        self.arms: tuple[str, str | None] | None = None
        self.answered = threading.Event()  # the state and the arm have come for the first time
        self._context, self._key = context, key
        self._loaded: tuple[object, object, object] | None = None
        self._wishes: dict[str, Value | None] = {}
        self._wanted = threading.Condition()
        self._over = False
        self._socket = self._connect()
        self._thread = threading.Thread(target=self._work, name="remote")
        self._thread.start()

    def want(self, cmd: str, value: Value | None = None) -> None:
        """Have something asked for soon; returns at once."""
        with self._wanted:
            before = self._wishes.pop(cmd, None)
            if cmd == "step" and value is not None and before is not None:
                value += before  # two steps are one twice as long
            self._wishes[cmd] = value
            self._wanted.notify()

    def close(self) -> None:
        """End the thread and free the socket."""
        with self._wanted:
            self._over = True
            self._wanted.notify()
        self._thread.join()
        self._socket.close(0)

    def _connect(self) -> "zmq.Socket[bytes]":
        socket = self._context.socket(zmq.REQ)
        socket.set(zmq.LINGER, 0)
        socket.set(zmq.MAXMSGSIZE, MESSAGE_BYTES)
        if self._key is not None:
            self._key.apply(socket)
        try:
            connect(socket, self.endpoint)
        except BaseException:
            socket.close(0)
            raise
        return socket

    def _work(self) -> None:
        due_s = time.monotonic()
        while True:
            with self._wanted:
                self._wanted.wait_for(lambda: self._over or bool(self._wishes), max(0.0, due_s - time.monotonic()))
                if self._over:
                    return
                wishes, self._wishes = self._wishes, {}
            for cmd, value in (wishes or {"state": None}).items():
                reply = self._ask(Request(cmd, value))
                if reply is not None and cmd != "state":
                    self.refusal = "" if reply["ok"] else str(reply.get("error", ""))
            self._look_up()
            due_s = time.monotonic() + STATE_S

    def _look_up(self) -> None:
        """Ask for the arm and the motion where they are not those of the state."""
        state = self.state
        if state is None:
            return
        if self._loaded is None or self._loaded[0] != state.get("run"):
            reply = self._ask(Request("arm"))
            if reply is None:
                return
            if reply["ok"] and isinstance(reply.get("arm"), str):
                twin = reply.get("twin")
                self.arms = reply["arm"], twin if isinstance(twin, str) else None
        loaded = state.get("run"), state.get("trial"), state.get("source")
        if loaded != self._loaded:
            reply = self._ask(Request("motion"))
            if reply is None:
                return
            try:
                self.motion = Motion(reply["motion"]) if reply["ok"] else None
            except (KeyError, TypeError, ValueError):
                self.motion = None
            self._loaded = loaded
        self.answered.set()

    def _ask(self, request: Request) -> Mapping[str, Any] | None:
        """Return the reply, or None if none came that can be read; then the line is made anew."""
        self._socket.send(encode_request(request))
        until_s = time.monotonic() + PATIENCE_S
        while not self._socket.poll(50):
            if self._over or time.monotonic() > until_s:
                break
        else:
            try:
                reply = decode_reply(receive_parts(self._socket, MESSAGE_BYTES).parts[-1])
            except ProtocolError:
                reply = {"ok": False, "error": "what answers there is no playback"}
            state = reply.get("state")
            if isinstance(state, dict):
                self.state = state
            return reply
        self.state = None
        self._socket.close(0)  # a REQ socket that waits for an answer cannot ask anew
        self._socket = self._connect()
        return None
