"""A hand that is simulated too: it touches the arm, pulls it along, lets it go, and does so again.

It is a mass with a damper, pulled by somebody who has a place in mind, and moved by what it feels back: a device
like a real one, whose motion nobody prescribes.
"""

import json
import math
import signal
import time
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any

import numpy as np
import zmq

from arm.model import Floats
from limbcal.errors import DeviceError, LimbcalError
from limbcal.interrupts import interrupts_held
from limbcal.real_time import PIPELINE, ask_for_real_time
from playback.touch.device import TouchDevice
from playback.touch.holders import STALE_S
from playback.touch.pace import Pace, Spread
from protocol.curve import ClientKey

#: How long the process may take to start, which may include compiling, and to stop [s].
_START_S, _STOP_S = 60.0, 5.0


@dataclass(frozen=True)
class HandModel:
    """A hand and whoever moves it.

    Attributes
    ----------
    mass_kg, damping_N_s_m : float
    pull_N_m, pull_N_s_m : float
        Stiffness and damping with which it is taken to where it is wanted.
    reach_m : float
        How far from where it touches the arm it is wanted.
    hold_s, rest_s : float
        How long it pulls before it lets go, and how long it is away.
    """

    mass_kg: float = 0.4
    damping_N_s_m: float = 5.0
    pull_N_m: float = 150.0
    pull_N_s_m: float = 12.0
    reach_m: float = 0.06
    hold_s: float = 2.4
    rest_s: float = 0.6

    def wanted(self, t: float) -> tuple[Floats, bool]:
        """Return how far from where it touched the hand is wanted (3,) [m], and whether it touches at all."""
        phase = t % (self.hold_s + self.rest_s)
        if phase >= self.hold_s:
            return np.zeros(3), False
        swing = 2.0 * math.pi * phase / self.hold_s
        return self.reach_m * np.array([math.sin(swing), math.sin(2.0 * swing) / 2.0, 0.0]), True

    def move(self, x: Floats, v: Floats, wanted: Floats, force: Floats, h: float) -> None:
        """Move the hand on by ``h`` seconds under the force that it feels; exact for a damper (velocity first)."""
        push = force + self.pull_N_m * (wanted - x)
        slowing = self.damping_N_s_m + self.pull_N_s_m
        fade = math.exp(-slowing * h / self.mass_kg)
        v *= fade
        v += (1.0 - fade) / slowing * push
        x += h * v


class VirtualHand:
    """A `HandModel` that speaks to a haptic loop a thousand times a second, from a process of its own.

    Parameters
    ----------
    haptic : str
        Endpoint of the haptic channel.
    model : HandModel, optional
    rate_hz : float
    key : ClientKey, optional
    """

    def __init__(
        self, haptic: str, model: HandModel | None = None, rate_hz: float = 1000.0, key: ClientKey | None = None
    ) -> None:
        self._summary: dict[str, Any] = {}
        context = get_context("spawn")
        self._line: Connection | None
        self._line, theirs = context.Pipe()
        arguments = (theirs, haptic, model or HandModel(), rate_hz, key)
        self._process = context.Process(target=_be_hand, args=arguments, name="limbplay-hand")
        with interrupts_held():
            self._process.start()
        theirs.close()

    def start(self) -> None:
        """Wait until it moves.

        Raises
        ------
        DeviceError
            If it cannot.
        """
        assert self._line is not None
        said = json.loads(self._line.recv_bytes()) if self._line.poll(_START_S) else {"failed": "it did not start"}
        if "failed" in said:
            raise DeviceError(f"the virtual hand failed: {said['failed']}")

    def check(self) -> None:
        """Look whether it still moves.

        Raises
        ------
        DeviceError
            If it does not, with what it said last.
        """
        if self._line is None or not self._line.poll():
            return
        try:
            self._summary = json.loads(self._line.recv_bytes())
        except (EOFError, OSError):
            self._summary = {"failed": "it is gone"}
        raise DeviceError(f"the virtual hand failed: {self._summary.get('failed')}")

    def close(self) -> dict[str, Any]:
        """End it and return what it has to tell; harmless when repeated."""
        if self._line is None:
            return self._summary
        with suppress(OSError):  # it is gone, but may have said why
            self._line.send_bytes(b"stop")
        try:
            while self._line.poll(_STOP_S):
                self._summary = json.loads(self._line.recv_bytes())
        except (EOFError, OSError):
            pass  # it has said its last
        self._process.join(_STOP_S)
        if self._process.is_alive():
            self._process.kill()
            self._process.join(_STOP_S)
        self._line.close()
        self._line = None
        return self._summary

    def __enter__(self) -> "VirtualHand":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _be_hand(line: Connection, haptic: str, model: HandModel, rate_hz: float, key: ClientKey | None) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # its parent ends it
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with zmq.Context() as context:
            ask_for_real_time(PIPELINE, context)  # the loop goes first
            with TouchDevice(context, haptic, key) as device:
                _run(line, device, model, 1.0 / rate_hz)
    except (LimbcalError, zmq.ZMQError) as error:
        line.send_bytes(json.dumps({"failed": str(error)}).encode())
    except (EOFError, ConnectionError):
        return
    finally:
        line.close()


def _run(line: Connection, device: TouchDevice, model: HandModel, h: float) -> None:
    """Touch, pull and let go until asked to stop."""
    home = _point(device)
    x, v, force = home.copy(), np.zeros(3), np.zeros(3)
    sent_s, heard_s, answers, touches, strongest = np.zeros(1024), 0.0, 0, 0, 0.0
    round_trip, touching, pace = Spread(), False, Pace(h)
    line.send_bytes(b"{}")
    while not line.poll() or line.recv_bytes() != b"stop":
        passed = pace.wait()
        now_s = time.monotonic()
        answer = device.latest()
        if answer is not None:
            force, heard_s = np.array(answer["force"], dtype=np.float64), now_s
            strongest = max(strongest, float(np.linalg.norm(force)))
            answers += 1
            round_trip.add(now_s - sent_s[int(str(answer["seq"])) % 1024])
        elif now_s - heard_s > STALE_S:
            force = np.zeros(3)
        wanted, touches_now = model.wanted(pace.now_s - pace.start_s)
        if touches_now:
            if not touching:
                home, touches = _point(device), touches + 1
                x[:], v[:], force = home, 0.0, np.zeros(3)
            for _ in range(min(passed, 20)):
                model.move(x, v, home + wanted, force, h)
            seq = device.send(x.tolist(), v.tolist())
            sent_s[seq % 1024] = time.monotonic()
        touching = touches_now
    figures = {
        "inputs": device.seq + 1,
        "answers": answers,
        "touches": touches,
        "rate_hz": pace.held_rate_hz,
        "round_trip_ms": round_trip.summary(1e-3),
        "strongest_force_N": strongest,
    }
    line.send_bytes(json.dumps(figures).encode())


def _point(device: TouchDevice) -> Floats:
    return np.array(device.ask("state")["point"], dtype=np.float64)
