"""A device on a real pseudo-terminal whose clock lies by a script, and which knows when each sample was taken."""

import os
import threading
import time
import tty
from collections.abc import Sequence
from dataclasses import dataclass, field
from select import select

import numpy as np
from numpy.typing import NDArray

from protocol.device_info import Channel, DeviceInfo
from protocol.serial_frame import encode_info, encode_samples

TICK_HZ, FRAME = 1e7, 32
_CHANNELS = tuple(f"s{k}{axis}" for k in (1, 2, 3, 4) for axis in "xyz")
_SCALE = 0.0015
#: Bits of a sample's number that each of the first channels carries as its reading, little enough for any arm.
_DIGIT_BITS, _DIGITS = 5, 7
#: Timers of this many bits are read in two halves.
_TORN = (16, 24, 32)
#: How often what is due is written [s].
_BEAT_S = 0.004
#: How long lies last, where they come once a minute [s].
_BAND = {"halt": (0.1, 5.0), "clock drifts": (5.0, 20.0), "oscillator drifts": (5.0, 20.0)}


@dataclass
class Lie:
    """One lie of a device's clock.

    ``lasts_s`` is 0 for what is done at once; ``by`` is a jump [s], a drift [ratio], or the bits of a torn read.
    ``frame`` is the first that lies, ``over`` the first that does not any more, where it is over.
    """

    kind: str
    at_s: float
    lasts_s: float
    by: float
    frame: int | None = None
    over: int | None = None

    @property
    def text(self) -> str:
        return f"{self.kind} at {self.at_s:.1f} s by {self.by:.3g} for {self.lasts_s:.2g} s"


def lies_of(seed: int, bits: int, kinds: Sequence[str], every_s: float, lasting_s: float) -> list[Lie]:
    """Draw lies at random, one in each stretch of time; all kinds come before one comes again."""
    rng = np.random.default_rng(seed)
    lies: list[Lie] = []
    for k in range(round(lasting_s / every_s)):
        if k % len(kinds) == 0:
            order = rng.permutation(kinds)
        kind = str(order[k % len(kinds)])
        at_s = every_s * (k + rng.uniform(0.1, 0.5))
        lasts_s = float(rng.uniform(*_BAND.get(kind, (0.0, 0.0)))) * min(1.0, every_s / 60.0)
        sign = float(rng.choice([-1.0, 1.0]))
        by = {
            "jump": sign * float(np.exp(rng.uniform(np.log(0.05), np.log(1e5)))),
            "torn": sign * float(rng.choice([torn for torn in _TORN if torn < bits])),
            "clock drifts": sign * float(np.exp(rng.uniform(np.log(0.01), np.log(0.1)))),
            "oscillator drifts": sign * float(np.exp(rng.uniform(np.log(0.01), np.log(0.1)))),
        }.get(kind, 0.0)
        lies.append(Lie(kind, at_s, lasts_s, by))
    return lies


def _digits(first: int) -> NDArray[np.int16]:
    number = np.arange(first, first + FRAME)
    counts = np.zeros((FRAME, len(_CHANNELS)), dtype=np.int16)
    for k in range(_DIGITS):
        counts[:, k] = (number >> (_DIGIT_BITS * k)) & ((1 << _DIGIT_BITS) - 1)
    return counts


def number_of(readings: NDArray[np.float32]) -> int:
    """Return the number that a sample carries in its readings [m/s^2]."""
    digits = np.rint(readings[:_DIGITS] / _SCALE).astype(int)
    return int(sum(int(digit) << (_DIGIT_BITS * k) for k, digit in enumerate(digits)))


@dataclass
class LyingDevice:
    """Streams from START on, in a thread of its own.

    Attributes
    ----------
    taken : list of (float, float)
        When the first sample of each frame was taken, by the host's monotonic clock, and from it to the next [s].
    """

    rate_hz: float
    lies: list[Lie]
    bits: int = 64
    starts_at: int = 1 << 31
    taken: list[tuple[float, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        channels = tuple(Channel(name, _SCALE, 0.0, 49.0) for name in _CHANNELS)
        self._info = DeviceInfo("a liar", "1", "1", self.rate_hz, TICK_HZ, channels)
        self._sequence, self._frame = 0, 0
        self._began_s: float | None = None
        self._due_s = 0.0
        self._ticks = float(self.starts_at)
        self._held: float | None = None
        self._out = bytearray()
        self._master, self._slave = os.openpty()
        self.path = os.ttyname(self._slave)
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self._over = threading.Event()
        self.failed: BaseException | None = None
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def close(self) -> None:
        self._over.set()
        self._thread.join()
        os.close(self._master)
        os.close(self._slave)

    def true_s(self, number: int) -> float:
        """Return when a sample was taken, by the host's monotonic clock."""
        began_s, period_s = self.taken[number // FRAME]
        return began_s + number % FRAME * period_s

    def _serve(self) -> None:
        try:
            heard = b""
            while not self._over.is_set():
                readable, _, _ = select([self._master], [], [], _BEAT_S)
                if readable:
                    *commands, heard = (heard + os.read(self._master, 4096)).split(b"\n")
                    for command in commands:
                        self._obey(command.strip())
                self._make(time.monotonic())
                self._drain()
        except BaseException as error:
            self.failed = error

    def _obey(self, command: bytes) -> None:
        if command in (b"INFO", b"START"):
            self._put(encode_info(self._info, self._sequence, self._whole(self._ticks)))
        if command == b"START" and self._began_s is None:
            self._began_s = self._due_s = time.monotonic()

    def _make(self, now_s: float) -> None:
        while self._began_s is not None:
            since_s = self._due_s - self._began_s
            acting = {lie.kind: lie.by for lie in self.lies if lie.at_s <= since_s < lie.at_s + lie.lasts_s}
            frame_s = FRAME / self.rate_hz / (1.0 + acting.get("oscillator drifts", 0.0))
            if now_s < self._due_s + frame_s:  # a frame leaves when its last sample was taken
                return
            torn = 0.0
            for lie in self.lies:
                if lie.frame is None and lie.at_s <= since_s:
                    lie.frame = self._frame
                    torn += self._begin(lie)
                if lie.over is None and lie.at_s + lie.lasts_s <= since_s:
                    lie.over = self._frame
            shown = self._held if "halt" in acting and self._held is not None else self._ticks
            self._put(encode_samples(_digits(self._frame * FRAME), self._sequence, self._whole(shown + torn)))
            self.taken.append((self._due_s, frame_s / FRAME))
            self._due_s += frame_s
            self._frame += 1
            self._ticks += FRAME / self.rate_hz * TICK_HZ * (1.0 + acting.get("clock drifts", 0.0))

    def _begin(self, lie: Lie) -> float:
        """Begin a lie; return by how much one frame's ticks are off."""
        if lie.kind == "jump":
            if self._ticks + lie.by * TICK_HZ < 0.0:
                lie.by = abs(lie.by)
            self._ticks += lie.by * TICK_HZ
        elif lie.kind == "to zero":
            self._ticks = 0.0
        elif lie.kind == "halt":
            self._held = self._ticks
        elif lie.kind == "torn":
            by = float(1 << round(abs(lie.by)))
            return by if lie.by > 0.0 or self._ticks < by else -by
        return 0.0

    def _whole(self, ticks: float) -> int:
        return round(ticks) % (1 << self.bits)

    def _put(self, frame: bytes) -> None:
        self._sequence += 1
        self._out += frame

    def _drain(self) -> None:
        while self._out:
            try:
                sent = os.write(self._master, self._out[:4096])
            except BlockingIOError:
                return
            del self._out[:sent]
