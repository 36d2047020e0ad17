"""Clients that mean harm: bytes on a plain socket, beyond what a library of ZeroMQ's would send."""

import itertools
import socket
import threading
import time
from collections.abc import Callable, Iterator

_GREETING = b"\xff" + bytes(8) + b"\x7f" + b"\x03\x00" + b"NULL".ljust(20, b"\x00") + bytes(32)
_MORE, _LONG, _COMMAND = 1, 2, 4
#: What is sent at a time [bytes].
_GULP = 1 << 16


def frame(body: bytes, flags: int = 0) -> bytes:
    """Return one frame of ZMTP 3.0 (RFC 23)."""
    if len(body) > 255:
        return bytes([flags | _LONG]) + len(body).to_bytes(8, "big") + body
    return bytes([flags, len(body)]) + body


def part(body: bytes) -> bytes:
    """Return a part of a message that does not end."""
    return frame(body, _MORE)


def handshake(kind: bytes) -> bytes:
    """Return what a client says first, without waiting for answers."""
    return _GREETING + frame(b"\x05READY\x0bSocket-Type" + len(kind).to_bytes(4, "big") + kind, _COMMAND)


def greet(line: socket.socket, kind: bytes) -> None:
    """Greet and wait until greeted: ZeroMQ ends whoever goes on before."""
    line.sendall(handshake(kind))
    heard = b""
    while len(heard) < 66 or len(heard) < 66 + heard[65]:
        more = line.recv(1000)
        if not more:
            raise ConnectionError("shown out while greeting")
        heard += more


def open_line(port: int) -> socket.socket:
    line = socket.create_connection(("127.0.0.1", port), timeout=30.0)
    line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return line


def send_until_shown_out(line: socket.socket, pieces: Iterator[bytes], most: int) -> int:
    """Send until the other end closes, or a number of bytes is sent; return how many were."""
    sent = 0
    try:
        while sent < most:
            gulp = bytearray()
            while len(gulp) < _GULP:
                gulp += next(pieces)
            line.sendall(gulp)
            sent += len(gulp)
    except OSError:
        pass
    return sent


def many_topics(length: int) -> Iterator[bytes]:
    """Subscribe to ever new topics."""
    return (frame(b"\x01" + f"{k:0{length}d}".encode()) for k in itertools.count())


def one_topic_again_and_again() -> Iterator[bytes]:
    """Subscribe and unsubscribe."""
    return (frame(kind + b"limb/health") for kind in itertools.cycle((b"\x01", b"\x00")))


def parts_without_end(size: int) -> Iterator[bytes]:
    """Send a message that does not end."""
    return itertools.repeat(part(b"\x02" * size))


def messages(size: int) -> Iterator[bytes]:
    """Send what is no subscription."""
    return itertools.repeat(frame(b"\x02" * size))


def noise() -> Iterator[bytes]:
    """Send what is no frame."""
    return itertools.repeat(b"\xff\xff\xff\xff\xff\xff\xff\xffGET / HTTP/1.1\r\n\r\n")


class Crowd:
    """Hostile clients, each in a thread that comes back whenever it is shown out.

    Attributes
    ----------
    sent, shown_out : list of int
        Bytes that each has sent, and how often it was shown out.
    """

    #: How long one that was shown out stays away [s].
    PACE_S = 0.02

    def __init__(self, acts: list[Callable[[threading.Event], int]]) -> None:
        self.sent, self.shown_out = [0] * len(acts), [0] * len(acts)
        self._over = threading.Event()
        self._threads = [threading.Thread(target=self._act, args=(k, act)) for k, act in enumerate(acts)]
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        self._over.set()
        for thread in self._threads:
            thread.join()

    def _act(self, k: int, act: Callable[[threading.Event], int]) -> None:
        while not self._over.is_set():
            try:
                self.sent[k] += act(self._over)
            except OSError:
                pass
            self.shown_out[k] += 1
            self._over.wait(self.PACE_S)


def sending(port: int, kind: bytes, pieces: Callable[[], Iterator[bytes]]) -> Callable[[threading.Event], int]:
    """Return a client that sends what is none of its business until it is shown out."""

    def act(over: threading.Event) -> int:
        with open_line(port) as line:
            greet(line, kind)
            sent, pile = 0, pieces()
            while not over.is_set():
                now = send_until_shown_out(line, pile, _GULP)
                sent += now
                if now < _GULP:
                    break
            return sent

    return act


def half_open(port: int, n: int) -> Callable[[threading.Event], int]:
    """Return clients that connect and say half of what they have to say."""

    def act(over: threading.Event) -> int:
        lines = []
        try:
            for _ in range(n):
                lines.append(open_line(port))
                lines[-1].sendall(_GREETING[:11])
            end_s = time.monotonic() + 5.0
            while not over.wait(0.05) and time.monotonic() < end_s:
                pass
        finally:
            for line in lines:
                line.close()
        return 11 * n

    return act
