"""Pages without a browser: what a page receives, counted, and one that receives nothing any more."""

import socket
import threading
import time

import msgspec
import viser
import zstandard
from websockets.sync.client import connect

#: What moves in every picture of an arm that plays.
MOVES = b"/arm/link2"
_SMALL = 4096


class Follower:
    """One page's connection, read as fast as it comes, from a thread of its own.

    Attributes
    ----------
    pictures : list of float
        When each picture of the arm came, on the monotonic clock [s].
    """

    def __init__(self, port: int) -> None:
        self.pictures: list[float] = []
        self.bytes = 0
        protocol = f"viser-v{viser.__version__}"
        self._line = connect(f"ws://127.0.0.1:{port}", subprotocols=[protocol], max_size=None, compression=None)
        self._unpack = zstandard.ZstdDecompressor()
        self._thread = threading.Thread(target=self._follow)
        self._thread.start()

    def close(self) -> None:
        self._line.close()
        self._thread.join()

    def _follow(self) -> None:
        for message in self._line:
            size = int.from_bytes(message[8:16], "little")
            self.bytes += len(message)
            text = self._unpack.decompress(message[16 : 16 + size])
            if MOVES in text and any(part.get("name") == MOVES.decode() for part in _messages(text)):
                self.pictures.append(time.monotonic())


def _messages(text: bytes) -> list[dict[str, object]]:
    messages: list[dict[str, object]] = msgspec.msgpack.decode(text)["messages"]
    return [message for message in messages if message.get("type") == "SetOrientationMessage"]


def stalled(port: int) -> socket.socket:
    """Return a page's connection from which nothing is ever read."""
    line = socket.socket()
    line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _SMALL)
    line.connect(("127.0.0.1", port))
    line.sendall(
        b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
        b"Sec-WebSocket-Protocol: viser-v" + viser.__version__.encode() + b"\r\n\r\n"
    )
    assert line.recv(12) == b"HTTP/1.1 101"
    return line
