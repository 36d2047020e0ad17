"""The simulated hand at work: what it says to a loop, and what it counts, by a clock that the test moves."""

import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from playback.touch import hand
from playback.touch.pace import Pace

PERIOD_S = 1.0 / 1024.0
POINT = np.array([1.0, 2.0, 3.0])


class Work:
    """Stands for clock, line, loop and model: touches while `touches` says so, and is stopped after that."""

    def __init__(self, touches: list[bool], answers: dict[int, tuple[int, list[float]]]) -> None:
        self.touches, self.answers = touches, answers
        self.now_s, self.tick, self.seq = 64.0, 0, -1
        self.said: list[bytes] = []
        self.sent: list[tuple[int, list[float], list[float]]] = []  # tick, position, velocity
        self.moves: list[tuple[int, list[float], list[float], float]] = []  # tick, wanted, force, seconds
        self.asked_s: list[float] = []
        self.late: dict[int, float] = {}

    def sleep(self, seconds: float) -> None:
        self.now_s += seconds + 40e-6 + self.late.get(self.tick, 0.0)

    def poll(self) -> bool:
        self.tick += 1
        return self.tick > len(self.touches) or self.tick == 2

    def recv_bytes(self) -> bytes:
        return b"go on" if self.tick == 2 else b"stop"

    def send_bytes(self, said: bytes) -> None:
        self.said.append(said)

    def ask(self, cmd: str) -> dict[str, object]:
        assert cmd == "state"
        return {"point": POINT.tolist()}

    def latest(self) -> dict[str, object] | None:
        if self.tick not in self.answers:
            return None
        seq, force = self.answers[self.tick]
        return {"seq": seq, "force": force}

    def send(self, position: list[float], velocity: list[float]) -> int:
        self.seq += 1
        self.sent.append((self.tick, position, velocity))
        return self.seq

    def wanted(self, t: float) -> tuple[np.ndarray, bool]:
        self.asked_s.append(t)
        return np.array([0.25, 0.0, 0.0]), self.touches[self.tick - 1]

    def move(self, x: np.ndarray, v: np.ndarray, wanted: np.ndarray, force: np.ndarray, h: float) -> None:
        self.moves.append((self.tick, wanted.tolist(), force.tolist(), h))
        v += 1.0
        x += 0.5


def worked(monkeypatch: pytest.MonkeyPatch, work: Work) -> dict[str, Any]:
    """Let a hand work, and return the figures it reports at the end."""
    monkeypatch.setattr(hand, "time", SimpleNamespace(monotonic=lambda: work.now_s))
    monkeypatch.setattr(hand, "Pace", lambda h: Pace(h, lambda: work.now_s, work.sleep))
    one: Any = work
    hand._run(one, one, one, PERIOD_S)
    assert work.said[0] == b"{}"  # it moves
    (report,) = work.said[1:]
    figures: dict[str, Any] = json.loads(report)
    return figures


def test_each_touch_begins_where_the_arm_is(monkeypatch: pytest.MonkeyPatch) -> None:
    work = Work([True, True, False, True, True, True], {})
    figures = worked(monkeypatch, work)
    assert work.sent == [
        (tick, (POINT + 0.5 * moves).tolist(), [1.0 * moves] * 3)
        for tick, moves in ((1, 1), (2, 2), (4, 1), (5, 2), (6, 3))
    ]
    assert [tick for tick, *_ in work.moves] == [1, 2, 4, 5, 6]
    assert all(wanted == [1.25, 2.0, 3.0] and h == PERIOD_S for _, wanted, _, h in work.moves)
    assert work.asked_s == pytest.approx([PERIOD_S * k for k in range(1, 7)], abs=1e-9)
    assert (figures["inputs"], figures["touches"], figures["answers"], figures["strongest_force_N"]) == (
        5,
        2,
        0,
        0.0,
    )
    assert figures["rate_hz"] == pytest.approx(1024.0)
    assert figures["round_trip_ms"] == {"p50": None, "p99": None, "max": None}


def test_what_it_feels_moves_it_until_it_lets_go(monkeypatch: pytest.MonkeyPatch) -> None:
    work = Work([True] * 4 + [False] + [True] * 2, {2: (1022, [3.0, 0.0, 4.0]), 4: (1024, [0.0, 1.0, 0.0])})
    work.seq = 1021  # when each of the last thousand was sent is known
    figures = worked(monkeypatch, work)
    forces = {tick: force for tick, _, force, _ in work.moves}
    rest = [0.0, 0.0, 0.0]
    assert forces == {
        **{1: rest, 2: [3.0, 0.0, 4.0], 3: [3.0, 0.0, 4.0], 4: [0.0, 1.0, 0.0]},
        **{6: rest, 7: rest},
    }
    assert (figures["answers"], figures["strongest_force_N"]) == (2, 5.0)
    assert figures["round_trip_ms"]["max"] == pytest.approx(1e3 * PERIOD_S)  # each came a tick after its input


def test_a_force_of_more_than_20_ms_ago_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    work = Work([True] * 24, {2: (0, [3.0, 0.0, 4.0])})
    worked(monkeypatch, work)
    felt = [tick for tick, _, force, _ in work.moves if any(force)]
    assert felt == list(range(2, 23))  # 20 ticks are 19.5 ms


def test_after_a_hold_up_it_makes_up_for_twenty_ticks_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    work = Work([True] * 4, {4: (1, [1.0, 0.0, 0.0])})
    work.late = {2: 2.5 * PERIOD_S, 3: 30.5 * PERIOD_S}
    figures = worked(monkeypatch, work)
    assert [sum(tick == k for tick, *_ in work.moves) for k in (1, 2, 3, 4)] == [1, 3, 20, 1]
    assert figures["rate_hz"] < 1024.0 and figures["inputs"] == 4
