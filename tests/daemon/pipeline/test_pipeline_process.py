"""The loop of the pipeline process, by a clock, a line, a ring and a pipeline of the test's."""

from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from daemon.acquisition.ring import Chunk
from daemon.clock.device_clock import DeviceClock
from daemon.config.config import load_setup
from daemon.pipeline import pipeline_process as module
from daemon.process.control_line import SupervisorGone
from limbcal.errors import DeviceError
from protocol.serial_frame import InfoFrame, encode_info, encode_samples
from protocol.serial_parser import FrameParser
from tests.daemon.conftest import device_info


class World:
    """All that the process has to do with; each look into the line takes 10 ms."""

    def __init__(self) -> None:
        self.now_s = 100.0
        self.said: dict[int, Any] = {}
        self.looks = 0
        self.reported: list[tuple[float, str, dict[str, Any]]] = []
        self.chunks: Iterator[list[Chunk]] = iter([])
        self.closes_s = float("inf")
        self.dropped_chunks = 0
        self.accepted: list[tuple[int, int]] = []
        self.attended = 0
        self.slept = 0
        self.awaits: Callable[[float], bool] = lambda _: False
        self.streams: Callable[[float], bool] = lambda _: False
        self.stall_s = 0.0

    # the line
    def hear(self, timeout_s: float = 0.0) -> Any:
        self.looks += 1
        self.now_s += timeout_s
        said = self.said.get(self.looks)
        if isinstance(said, Exception):
            raise said
        return said

    def tell(self, what: str, **fields: Any) -> None:
        self.reported.append((round(self.now_s - 100.0, 3), what, fields))

    # the ring
    @property
    def closed(self) -> bool:
        return self.now_s - 100.0 >= self.closes_s - 1e-9

    def read(self) -> list[Chunk]:
        return next(self.chunks, [])

    # the pipeline
    def accept(self, chunks: list[Chunk], dropped: int) -> None:
        self.accepted.append((len(chunks), dropped))
        self.now_s += self.stall_s
        self.stall_s = 0.0

    @property
    def awaits_info(self) -> bool:
        return self.awaits(self.now_s - 100.0)

    @property
    def streaming(self) -> bool:
        return self.streams(self.now_s - 100.0)

    def report(self, connected: bool) -> dict[str, Any]:
        return {"connected": connected}

    # the publisher, and the time
    def attend(self) -> None:
        self.attended += 1

    def monotonic(self) -> float:
        return self.now_s

    def monotonic_ns(self) -> int:
        return round(1e9 * self.now_s)

    def sleep(self, seconds: float) -> None:
        self.slept += 1
        self.now_s += seconds

    def times(self, what: str) -> list[float]:
        return [at_s for at_s, reported, _ in self.reported if reported == what]


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    made = World()
    clock = SimpleNamespace(monotonic=made.monotonic, monotonic_ns=made.monotonic_ns, sleep=made.sleep)
    monkeypatch.setattr(module, "time", clock)
    return made


def stream(world: World) -> None:
    module._stream(world, world, world, world)  # type: ignore[arg-type]


def test_what_was_written_before_the_close_is_still_taken(world: World) -> None:
    world.closes_s, world.dropped_chunks = 0.0, 7
    world.chunks = iter([[Chunk(1, b"a")], [Chunk(2, b"b"), Chunk(3, b"c")]])
    stream(world)
    assert world.accepted == [(1, 7), (2, 7), (0, 7)] and world.attended == 3


def test_health_is_told_once_a_second_and_never_made_up_for(world: World) -> None:
    world.closes_s = 3.5
    stream(world)
    assert world.times("health") == pytest.approx([1.0, 2.0, 3.0], abs=0.011)
    assert [fields for _, what, fields in world.reported if what == "health"] == [{"connected": True}] * 3
    world.reported.clear()
    world.now_s, world.closes_s, world.stall_s = 100.0, 6.5, 3.25
    stream(world)
    assert world.times("health") == pytest.approx([3.25, 4.0, 5.0, 6.0], abs=0.025)


def test_while_the_ring_is_emptied_after_its_end_nothing_is_connected(world: World) -> None:
    world.closes_s = 0.0
    world.chunks = iter([[Chunk(k, b"a")] for k in range(150)])
    stream(world)
    assert [fields for _, what, fields in world.reported if what == "health"] == [{"connected": False}]


def test_a_device_that_came_back_is_asked_once_a_second_what_it_is(world: World) -> None:
    world.closes_s, world.awaits = 5.0, lambda at_s: 1.0 <= at_s < 3.5
    stream(world)
    assert world.times("ask") == pytest.approx([1.0, 2.0, 3.0], abs=0.03)


def test_every_time_that_samples_begin_to_stream_is_told(world: World) -> None:
    world.closes_s, world.streams = 3.0, lambda at_s: at_s >= 0.5 and not 1.0 <= at_s < 2.0
    stream(world)
    assert world.times("streaming") == pytest.approx([0.5, 2.0], abs=0.011)


@pytest.mark.parametrize("said", [{"what": "stop"}, SupervisorGone()])
def test_after_a_stop_a_reader_that_never_closes_is_given_up(world: World, said: Any) -> None:
    world.said = {50: said, 20: {"what": "something else"}}
    stream(world)
    assert world.now_s - 100.0 == pytest.approx(0.5 + 5.0, abs=0.03)
    assert world.looks == 50 and world.slept > 400  # nobody is listened to any more


def test_after_a_stop_all_that_comes_is_taken(world: World) -> None:
    world.said = {1: {"what": "stop"}}
    world.chunks = iter([[Chunk(k, b"a")] for k in range(600)])
    stream(world)
    assert sum(n for n, _ in world.accepted) == 600


SETUP = load_setup(None, {"device": {"port": "/dev/ttyX"}, "arm": {"file": "dd-arm"}})


def introduced(world: World, *read: bytes) -> InfoFrame | None:
    world.chunks = iter([[Chunk(1, data)] if data else [] for data in read])
    return module._introduction(world, world, FrameParser(), SETUP, world)  # type: ignore[arg-type]


def test_the_ring_is_left_alone_until_the_device_was_asked(world: World) -> None:
    world.said = {5: {"what": "handshake", "wait": False}}
    found = introduced(world, b"", encode_info(device_info(), 3, 9))
    assert found is not None and (found.sequence, found.ticks) == (3, 9)
    assert world.looks == 6 and world.times("heard") == [0.06]


@pytest.mark.parametrize("said", [{"what": "stop"}, SupervisorGone()])
def test_who_is_told_to_stop_knows_no_device(world: World, said: Any) -> None:
    world.said = {1: {"what": "handshake", "wait": True}, 4: said}
    assert introduced(world) is None
    assert world.looks == 4 and world.reported == []


def test_another_arm_s_device_ends_the_run_or_is_waited_out(world: World) -> None:
    other, own = encode_info(device_info(names=["x", "y"]), 0, 0), encode_info(device_info(), 0, 0)
    world.said = {1: {"what": "handshake", "wait": False}}
    with pytest.raises(DeviceError, match="channels are x y, expected .*; `limbd run --wait` waits for it"):
        introduced(world, other)
    waiting = World()
    waiting.said = {1: {"what": "handshake", "wait": True}}
    found = introduced(waiting, other, b"", own)
    assert found is not None and found.info == device_info()
    assert [what for _, what, _ in waiting.reported] == ["waiting", "heard"]
    assert "channels are x y" in waiting.reported[0][2]["sentence"]


def test_a_device_runs_by_a_clock_of_its_own() -> None:
    reception = module._reception(SETUP, FrameParser(), InfoFrame(0, 0, device_info()))
    reception.take([Chunk(10**9, encode_samples(np.zeros((32, 12), dtype=np.int16), 1, 0))])
    assert isinstance(reception.clock, DeviceClock)
