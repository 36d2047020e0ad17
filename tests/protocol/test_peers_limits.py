"""What a connection may send, how many there may be and who goes first, on a clock that passes when asked to."""

import os
import socket as posix
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import SimpleNamespace

import pytest
import zmq

import protocol.peers as module
from protocol.parts import receive_parts
from protocol.peers import FREE_BYTES_S, LOOK_S, Peers
from tests.hostile import greet, handshake, open_line, part
from tests.patience import PATIENCE_MS, PATIENCE_S

GREETED = len(handshake(b"DEALER"))
LIMIT = 2000


class Door:
    """A socket that others connect to, and who is let stay; a look takes `LOOK_S` of its clock."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now_s = 50.0
        monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: self.now_s))
        self.context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        self.router = self.context.socket(zmq.ROUTER)
        self.peers = Peers(self.context, self.router, LIMIT)
        self.port = self.router.bind_to_random_port("tcp://127.0.0.1")
        self.lines: list[posix.socket] = []

    def look(self) -> None:
        self.now_s += LOOK_S
        self.peers.look()

    def come(self, greeted: bool = True) -> posix.socket:
        """Let one more connect, and be seen at this time."""
        known = self._known()
        line = open_line(self.port)
        self.lines.append(line)
        if greeted:
            greet(line, b"DEALER")
        until(lambda: self._known() != known)
        return line

    def _known(self) -> tuple[int, set[int]]:
        self.peers._hear(self.now_s)
        return self.peers.refused, set(self.peers._open)

    def close(self) -> None:
        for line in self.lines:
            line.close()
        self.peers.close()
        self.peers.close()  # harmless
        self.router.close(0)
        self.context.term()


def until(done: Callable[[], bool]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not done():
        assert time.monotonic() < end_s


@pytest.fixture
def door(monkeypatch: pytest.MonkeyPatch) -> Iterator[Door]:
    made = Door(monkeypatch)
    yield made
    made.close()


def is_ended(line: posix.socket) -> bool:
    """Wait until the other end has closed it."""
    line.settimeout(PATIENCE_S)
    with suppress(ConnectionResetError):
        while line.recv(1000):
            pass
    return True


@pytest.mark.parametrize("after_s", [0.0, 0.5, 30.0])
def test_what_nobody_was_handed_may_be_so_much_and_more_with_time(door: Door, after_s: float) -> None:
    line = door.come()
    free = LIMIT + round(FREE_BYTES_S * (after_s + LOOK_S))
    line.sendall((-(-free // 252) * part(bytes(250)))[: free - 1 - GREETED])
    door.now_s += after_s
    door.look()
    assert door.peers.refused == 0
    line.sendall(bytes(3))  # one is free by now, and one was left
    door.look()
    assert door.peers.refused == 1
    assert is_ended(line)
    door.look()
    assert door.peers.refused == 1


def test_what_was_handed_on_is_not_held_against_a_peer(door: Door) -> None:
    dealer = door.context.socket(zmq.DEALER)
    dealer.linger = 0
    dealer.connect(f"tcp://127.0.0.1:{door.port}")
    try:
        for _ in range(5):
            dealer.send(bytes(1500))
            assert door.router.poll(PATIENCE_MS)
            received = receive_parts(door.router, 10_000)
            place = door.peers.handed(received.first, received.n_byte)
            assert place is not None and os.fstat(place[0]).st_ino == place[1]
            door.look()
        assert door.peers.refused == 0
        door.peers.refuse(place[0], place[1] + 1)  # another connection, that had the number before
        assert door.peers.refused == 0 and not door.peers.is_refused(place[1])
        door.peers.refuse(*place)
        assert door.peers.is_refused(place[1])
        door.peers.refuse(*place)
        assert door.peers.refused == 1
    finally:
        dealer.close()


def test_what_its_parts_are_guessed_to_take_is_no_credit(door: Door) -> None:
    dealer = door.context.socket(zmq.DEALER)
    dealer.linger = 0
    dealer.connect(f"tcp://127.0.0.1:{door.port}")
    try:
        dealer.send(b"x")
        assert door.router.poll(PATIENCE_MS)
        received = receive_parts(door.router, 10_000)
        door.peers.handed(received.first, 10**6)
        door.look()
        dealer.send_multipart([bytes(LIMIT + 500)])
        assert door.router.poll(PATIENCE_MS)  # it is there, and nobody was handed it
        door.look()
        assert door.peers.refused == 1
    finally:
        dealer.close()


def test_of_too_many_the_one_that_has_been_mute_for_longest_goes(
    door: Door, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MOST_CONNECTIONS", 3)
    heard = door.come()
    heard.sendall(b"\x00\x02hi")
    assert door.router.poll(PATIENCE_MS)
    received = receive_parts(door.router, 100)
    door.peers.handed(received.first, received.n_byte)
    mute = [door.come(greeted=False) for _ in range(2)]
    assert door.peers.refused == 0
    last = door.come(greeted=False)
    assert door.peers.refused == 1 and is_ended(mute[0])
    for line in (heard, mute[1], last):
        line.setblocking(False)
        with pytest.raises(BlockingIOError):
            while line.recv(1000):
                pass


def test_where_all_were_heard_the_newcomer_goes(door: Door, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_CONNECTIONS", 1)
    heard = door.come()
    heard.sendall(b"\x00\x02hi")
    assert door.router.poll(PATIENCE_MS)
    door.peers.handed(receive_parts(door.router, 100).first)
    late = door.come(greeted=False)
    assert door.peers.refused == 1 and is_ended(late)


def test_one_of_this_process_is_no_connection(door: Door) -> None:
    with door.context.socket(zmq.PAIR) as one, door.context.socket(zmq.PAIR) as two:
        one.bind("inproc://pair")
        two.connect("inproc://pair")
        one.send(b"x")
        assert door.peers.handed(two.recv(copy=False), 10) is None


def test_who_comes_by_is_looked_at_when_it_is_time(door: Door) -> None:
    line = door.come()
    door.look()
    line.sendall(part(bytes(LIMIT)))
    door.now_s += 0.99 * LOOK_S
    door.peers.look()
    assert door.peers.refused == 0
    door.now_s += 0.02 * LOOK_S
    door.peers.look()
    assert door.peers.refused == 1
