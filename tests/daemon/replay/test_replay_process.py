"""The loop of the replay process, by a line and a device of the test's: when all has been read."""

from typing import Any

import pytest

from daemon.process.control_line import SupervisorGone
from daemon.replay import replay_process as module


class Ticker:
    """Beats at once."""

    def __init__(self, beat_s: float, *_: object) -> None:
        self.beat_s = beat_s

    def wait(self) -> None:
        pass

    def skip_missed(self) -> None:
        pass


class Line:
    """Lets the loop beat a number of times."""

    def __init__(self, beats: int, end: Any = None) -> None:
        self.beats, self.end = beats, end or {"what": "stop"}
        self.reported: list[tuple[str, int]] = []
        self.heard = 0

    def hear(self) -> Any:
        self.heard += 1
        if self.heard > self.beats:
            if isinstance(self.end, Exception):
                raise self.end
            return self.end
        return None if self.heard % 2 else {"what": "something else"}

    def tell(self, what: str) -> None:
        self.reported.append((what, self.heard))


class Out:
    """What waits for the reader: bytes, of which each look takes one."""

    def __init__(self, held: int) -> None:
        self.held, self.drained = held, 0

    def __len__(self) -> int:
        return self.held

    def drain(self, _write: object) -> None:
        self.drained += 1
        self.held = max(self.held - 1, 0)


class Device:
    def __init__(self, played_after: int, held: int = 0) -> None:
        self.out, self.left, self.played = Out(held), played_after, False

    def advance(self, _now_s: float) -> None:
        self.left -= 1
        self.played = self.left < 0


class Port:
    write = None


def replayed(beats: int, device: Device, monkeypatch: pytest.MonkeyPatch, end: Any = None) -> Line:
    monkeypatch.setattr(module, "Ticker", Ticker)
    line = Line(beats, end)
    module._serve(line, Port(), device)  # type: ignore[arg-type]
    return line


@pytest.mark.parametrize(("played_after", "held"), [(0, 0), (50, 0), (0, 70)])
def test_all_is_read_half_a_second_after_the_last_byte_left(
    played_after: int, held: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = replayed(400, Device(played_after, held), monkeypatch)
    ((what, beat),) = line.reported
    assert what == "played" and beat - max(played_after, held) in range(98, 104)  # 5 ms each


def test_while_there_is_more_it_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    device = Device(10**6)
    assert replayed(300, device, monkeypatch).reported == [] and device.out.drained == 300
    assert replayed(300, Device(0, 10**6), monkeypatch).reported == []


def test_it_ends_with_its_supervisor(monkeypatch: pytest.MonkeyPatch) -> None:
    device = Device(0)
    replayed(3, device, monkeypatch, SupervisorGone())
    assert device.left == -3
