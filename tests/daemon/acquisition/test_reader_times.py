"""When the reader tries, starts again, looks and gathers: on a clock that passes only while it waits."""

import itertools
import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
import serial

import daemon.acquisition.reader as module
from daemon.acquisition.reader import run_reader
from daemon.acquisition.ring import Mark
from limbcal.errors import DeviceError

#: A tty hands over no more at once.
A_READ = 4095
Said = list[tuple[float, str]]


class World:
    """A port, what a supervisor says and when, what the device sends and when; and what came of it."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.said: Said = []
        self.sent: list[tuple[float, bytes]] = []
        self.mistake: Callable[[float], Exception | None] = lambda _: None
        self.exists: Callable[[float], bool] = lambda _: True
        self.device: Callable[[float], int] = lambda _: 1
        self.reported: list[tuple[float, str, dict[str, Any]]] = []
        self.written: Said = []
        self.ring: list[tuple[float, bytes, Mark]] = []
        self.naps: list[float] = []
        self.looks: list[float] = []
        self.opened: list[tuple[str, int]] = []
        self.closed = 0

    def times(self, what: str) -> list[float]:
        return [time_s for time_s, report, _ in self.reported if report == what]

    def started(self) -> list[float]:
        return [time_s for time_s, text in self.written if text == "START\n"]

    # the supervisor's line
    def hear(self) -> dict[str, str] | None:
        return {"what": self.said.pop(0)[1]} if self.said and self.said[0][0] <= self.now_s else None

    def tell(self, what: str, **fields: object) -> None:
        self.reported.append((self.now_s, what, fields))

    # what the reader calls
    def open(self, port: str, baud: int) -> "Tty":
        self.opened.append((port, baud))
        if (mistake := self.mistake(self.now_s)) is not None:
            raise mistake
        return Tty(self)

    def select(self, waited: list[object], *_: object) -> tuple[list[object], list[object], list[object]]:
        assert _[-1] >= 0.0, "timeout must be non-negative"  # type: ignore[operator]
        end_s = self.now_s + max(_[-1], 1e-6)  # type: ignore[call-overload]
        due_s = {
            one: next((time_s for time_s, _ in (self.sent if isinstance(one, Tty) else self.said)), math.inf)
            for one in waited
        }
        self.now_s = max(self.now_s, min([end_s, *due_s.values()]))
        return [one for one in waited if due_s[one] <= self.now_s], [], []

    def sleep(self, seconds: float) -> None:
        self.naps.append(seconds)
        self.now_s += seconds

    def take(self, most: int) -> bytes:
        """Return what the device has sent by now, up to some bytes."""
        data = b"".join(data for time_s, data in self.sent if time_s <= self.now_s)
        later = [one for one in self.sent if one[0] > self.now_s]
        self.sent = [(self.now_s, data[most:]), *later] if len(data) > most else later
        return data[:most]

    def readv(self, _descriptor: int, places: list[memoryview]) -> int:
        data = self.take(min(A_READ, len(places[0])))
        places[0][: len(data)] = data
        return len(data)

    def stat(self, _port: str) -> SimpleNamespace:
        self.looks.append(self.now_s)
        return SimpleNamespace(st_rdev=self.device(self.now_s))


class Tty:
    def __init__(self, world: World) -> None:
        self._world = world

    def fileno(self) -> int:
        return 7

    def write(self, data: bytes) -> None:
        self._world.written.append((self._world.now_s, data.decode()))

    def read(self, most: int) -> bytes:
        return self._world.take(most)

    def close(self) -> None:
        self._world.closed += 1


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    made = World()

    def write(data: bytes, stamp_ns: int, mark: Mark = Mark.DATA) -> None:
        made.ring.append((1e-9 * stamp_ns, bytes(data), mark))

    names = {
        "time": SimpleNamespace(
            monotonic=lambda: made.now_s, monotonic_ns=lambda: round(1e9 * made.now_s), sleep=made.sleep
        ),
        "select": made.select,
        "open_port": made.open,
        "Ring": lambda _: SimpleNamespace(write=write, close=lambda: None),
        "os": SimpleNamespace(
            path=SimpleNamespace(exists=lambda _: made.exists(made.now_s)),
            stat=made.stat,
            fstat=lambda _: SimpleNamespace(st_rdev=1),
            readv=made.readv,
        ),
    }
    for name, value in names.items():
        monkeypatch.setattr(module, name, value)
    return made


def run(world: World, stop_s: float, wait: bool = True) -> None:
    world.said = sorted([*world.said, (stop_s, "stop")])
    run_reader(world, None, "/dev/x", 115_200, wait)  # type: ignore[arg-type]


def refused_until(time_s: float, why: str = "taken") -> Callable[[float], Exception | None]:
    return lambda now_s: DeviceError(why) if now_s < time_s else None


def test_a_refused_port_is_tried_ever_less_often(world: World) -> None:
    world.mistake = refused_until(99.0)
    run(world, 4.0)
    assert world.times("trying") == pytest.approx([0.0, 0.1, 0.3, 0.7, 1.5, 2.5, 3.5])
    assert [fields["sentence"] for _, what, fields in world.reported if what == "waiting"] == ["taken"]
    assert set(world.opened) == {("/dev/x", 115_200)}
    assert not world.ring and not world.written


def test_another_reason_is_said_anew(world: World) -> None:
    world.mistake = lambda now_s: DeviceError("taken" if now_s < 0.2 else "not allowed")
    run(world, 1.0)
    said = [fields["sentence"] for _, what, fields in world.reported if what == "waiting"]
    assert said == ["taken", "not allowed"]


def test_a_port_that_was_taken_is_ready_at_the_next_try(world: World) -> None:
    world.mistake = refused_until(0.8)
    run(world, 4.0)
    assert world.times("ready") == pytest.approx([1.5 + 0.1])  # the try, and a tenth of a second of silence
    assert world.written[0] == (pytest.approx(1.5), "STOP\n")


def test_a_name_that_appears_is_opened_within_a_twentieth_of_a_second(world: World) -> None:
    world.exists = lambda now_s: now_s >= 1.6
    world.mistake = refused_until(1.6)
    run(world, 4.0)
    (ready_s,) = world.times("ready")
    assert 1.7 - 1e-9 <= ready_s <= 1.75 + 1e-9
    assert world.times("trying") == pytest.approx([0.0, 0.1, 0.3, 0.7, 1.5], abs=0.051)


def test_a_name_that_appears_and_may_not_be_opened_is_tried_soon_again(world: World) -> None:
    world.exists = lambda now_s: now_s >= 1.6
    world.mistake = refused_until(99.0)
    run(world, 2.2)
    tries = [time_s for time_s in world.times("trying") if time_s > 1.55]
    assert tries[0] == pytest.approx(1.625, abs=0.026)
    assert [after - before for before, after in itertools.pairwise(tries)] == pytest.approx([0.1, 0.2], abs=1e-6)


def test_where_the_next_try_is_overdue_it_is_not_waited_for(world: World) -> None:
    def exists(now_s: float) -> bool:
        world.now_s = now_s + 0.2  # a file system that takes its time, over the end of the first pause
        return False

    world.exists, world.mistake = exists, refused_until(99.0)
    run(world, 1.0)
    assert [fields["sentence"] for _, what, fields in world.reported if what == "waiting"] == ["taken"]


def test_without_waiting_a_port_that_is_refused_ends_it(world: World) -> None:
    world.mistake = refused_until(99.0, "port /dev/x does not exist")
    with pytest.raises(DeviceError, match="^port /dev/x does not exist$"):
        run(world, 4.0, wait=False)
    world.mistake = lambda _: serial.SerialException("broken")
    with pytest.raises(DeviceError, match="^port /dev/x: the device went away while it was read: broken$"):
        run(world, 4.0, wait=False)


@pytest.mark.parametrize(("every_s", "n", "ready_s"), [(0.09, 5, 0.55), (0.11, 5, 0.1), (0.05, 100, 1.0)])
def test_the_line_is_drained_until_it_is_silent(world: World, every_s: float, n: int, ready_s: float) -> None:
    world.sent = [(every_s * k, b"old") for k in range(1, n + 1)]
    run(world, 0.05 + every_s * n + 1.0)
    assert world.times("ready") == pytest.approx([ready_s], abs=0.026)


def test_a_device_that_is_silent_is_started_ever_more_seldom(world: World) -> None:
    world.said = [(1.0, "start")]
    run(world, 12.0)
    due = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 9.0, 11.0]
    started = world.started()
    assert len(started) == len(due)
    assert all(0.0 <= got - want <= 0.25 + 1e-9 for got, want in zip(started, due, strict=True))


def test_whoever_was_heard_is_not_started_again(world: World) -> None:
    world.said = [(1.0, "start")]
    world.sent = [(1.0 + 0.4 * k, b"samples") for k in range(1, 11)]
    run(world, 7.5)
    started = world.started()
    assert started[0] == pytest.approx(1.0)
    assert started[1:] == pytest.approx([5.5, 6.0, 7.0], abs=0.27)  # half a second after the last, and so on anew


def test_a_device_that_was_not_started_is_left_alone(world: World) -> None:
    world.said = [(1.0, "ask")]
    run(world, 8.0)
    assert [text for _, text in world.written] == ["STOP\n", "INFO\n", "STOP\n"]


def test_each_read_is_waited_for_a_while_and_less_where_much_comes(world: World) -> None:
    sizes = [100, 8191, 8192, 16_384, 65_536, 100]
    world.sent = [(1.0 + 0.1 * k, bytes(size)) for k, size in enumerate(sizes)]
    run(world, 2.0)
    assert [len(data) for _, data, _ in world.ring] == sizes
    # the nap is after the read that it goes by, and only one
    assert world.naps == pytest.approx([0.006, 0.006, 0.006, 0.003, 0.00075, 0.006])


def test_of_a_flood_no_more_than_64_reads_are_taken_at_once(world: World) -> None:
    world.sent = [(1.0, bytes(64 * A_READ + 1))]
    run(world, 2.0)
    assert [len(data) for _, data, _ in world.ring] == [64 * A_READ, 1]
    assert world.ring[0][0] == pytest.approx(1.0)


@pytest.mark.parametrize("size", [1, A_READ - 1, A_READ, A_READ + 1, 2 * A_READ])
def test_all_that_has_come_is_one_chunk(world: World, size: int) -> None:
    world.sent = [(1.0, bytes(size))]
    run(world, 2.0)
    assert [(len(data), mark) for _, data, mark in world.ring] == [(size, Mark.DATA)]


def test_the_name_is_looked_at_every_half_second(world: World) -> None:
    run(world, 6.0)
    steps = [after - before for before, after in itertools.pairwise(world.looks)]
    assert len(steps) >= 6
    assert all(0.5 - 1e-9 <= step <= 0.75 + 1e-9 for step in steps)


def test_a_name_that_means_another_device_is_opened_anew(world: World) -> None:
    world.said = [(1.0, "start")]
    world.device = lambda now_s: 2 if now_s >= 2.0 and not world.times("waiting") else 1
    run(world, 4.0, wait=False)
    marks = [mark for *_, mark in world.ring if mark is not Mark.ASKED]
    assert marks == [Mark.LOST, Mark.OPENED] and world.ring[-1][2] is Mark.ASKED  # after it was opened
    ((lost_s, said, _), (opened_s, nothing, _)) = (one for one in world.ring if one[2] in marks)
    assert nothing == b""
    assert said.decode() == "port /dev/x: the device went away (its name has come to mean another device file)"
    assert 2.0 <= lost_s <= 2.75 and opened_s == pytest.approx(lost_s + 0.05)
    assert world.times("reopened") == [pytest.approx(opened_s)]
    assert [fields["sentence"] for _, what, fields in world.reported if what == "waiting"] == [said.decode()]
    assert world.times("ready") == pytest.approx([0.1])  # once
    assert world.started()[-1] >= opened_s and world.closed == 2


def test_a_readable_port_without_a_byte_has_gone(world: World) -> None:
    world.sent = [(1.0, b"")]
    with pytest.raises(DeviceError, match="went away while it was read: it is readable, and nothing comes"):
        run(world, 2.0, wait=False)
    assert world.ring == []


def test_after_a_stop_what_still_comes_is_read_until_it_is_quiet(world: World) -> None:
    world.sent = [(2.0 + 0.08 * k, b"x") for k in range(1, 6)] + [(2.6, b"late")]
    run(world, 2.0)
    assert b"".join(data for _, data, _ in world.ring) == b"xxxxx"
    assert world.written[-1] == (pytest.approx(2.0), "STOP\n")
    assert world.closed == 1
