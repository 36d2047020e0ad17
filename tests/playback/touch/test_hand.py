"""The hand that is simulated: where it is wanted, and how a mass with a damper gets there."""

import json
import math
import os
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbcal.errors import DeviceError
from playback.touch import hand
from playback.touch.hand import HandModel

MODEL = HandModel()


@given(st.floats(0.0, 100.0))
def test_it_is_wanted_again_and_again(t: float) -> None:
    period_s = MODEL.hold_s + MODEL.rest_s
    phase = math.fmod(t, period_s)
    if min(abs(phase - edge) for edge in (0.0, MODEL.hold_s, period_s)) < 1e-6:
        return
    place, touches = MODEL.wanted(t)
    assert touches == (phase < MODEL.hold_s)
    assert np.linalg.norm(place) <= MODEL.reach_m * 1.12  # an eight, as wide as its reach
    assert place[2] == 0.0
    again, touches_again = MODEL.wanted(t + period_s)
    assert touches_again == touches and again == pytest.approx(place, abs=1e-6)
    if not touches:
        assert not place.any()


def test_it_goes_an_eight() -> None:
    quarter = MODEL.hold_s / 4.0
    places = [MODEL.wanted(k * quarter / 2.0)[0][:2] / MODEL.reach_m for k in range(8)]
    s = math.sqrt(0.5)
    expected = [(0, 0), (s, 0.5), (1, 0), (s, -0.5), (0, 0), (-s, 0.5), (-1, 0), (-s, -0.5)]
    assert places == [pytest.approx(one, abs=1e-12) for one in expected]


def moved(force: np.ndarray, wanted: np.ndarray, seconds: float, h: float = 1e-4) -> tuple[np.ndarray, np.ndarray]:
    x, v = np.zeros(3), np.zeros(3)
    for _ in range(round(seconds / h)):
        MODEL.move(x, v, wanted, force, h)
    return x, v


def test_it_comes_to_rest_where_it_is_pulled() -> None:
    wanted, force = np.array([0.05, 0.0, -0.02]), np.array([0.0, 3.0, 0.0])
    x, v = moved(force, wanted, 3.0)
    assert x == pytest.approx(wanted + force / MODEL.pull_N_m, abs=1e-6)
    assert v == pytest.approx(np.zeros(3), abs=1e-6)


def test_at_first_a_force_accelerates_its_mass() -> None:
    _, v = moved(np.array([2.0, 0.0, 0.0]), np.zeros(3), 1e-3, 1e-5)
    assert v[0] == pytest.approx(2.0 / MODEL.mass_kg * 1e-3, rel=0.03)


def test_it_swings_as_a_damped_mass_on_a_spring_does() -> None:
    """Against the solution of m x'' + c x' + k x = k w, here under-damped only if c is small."""
    m, c, k = MODEL.mass_kg, MODEL.damping_N_s_m + MODEL.pull_N_s_m, MODEL.pull_N_m
    roots = np.roots([m, c, k])
    t, w = 0.15, 0.04
    slow, fast = roots
    exact = w * (1.0 + (fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (slow - fast)).real
    x, _ = moved(np.zeros(3), np.array([w, 0.0, 0.0]), t, 1e-5)
    assert x[0] == pytest.approx(exact, rel=1e-3)


def test_its_damping_lets_it_swing_past_nothing() -> None:
    x, v, wanted = np.zeros(3), np.zeros(3), np.array([MODEL.reach_m, 0.0, 0.0])
    for _ in range(5000):
        MODEL.move(x, v, wanted, np.zeros(3), 1e-3)
        assert x[0] <= MODEL.reach_m + 1e-12
    assert x == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("said", [b'{"failed": "the loop is gone"}', b""], ids=["says why", "says nothing"])
def test_a_hand_that_has_failed_is_noticed_and_says_why(monkeypatch: pytest.MonkeyPatch, said: bytes) -> None:
    monkeypatch.setattr(hand, "get_context", lambda _: SimpleNamespace(Pipe=Pipe, Process=Ended))
    failed = hand.VirtualHand("nowhere")
    theirs = Ended.lines.pop()
    failed.check()
    if said:
        theirs.send_bytes(said)
    theirs.close()
    with pytest.raises(DeviceError, match="the loop is gone" if said else "it is gone"):
        failed.check()
    assert failed.close() == (json.loads(said) if said else {"failed": "it is gone"})


def test_what_a_hand_said_last_is_heard_though_it_is_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hand, "get_context", lambda _: SimpleNamespace(Pipe=Pipe, Process=Ended))
    failed = hand.VirtualHand("nowhere")
    theirs = Ended.lines.pop()
    theirs.send_bytes(b'{"failed": "the loop is gone"}')
    theirs.close()
    assert failed.close() == {"failed": "the loop is gone"}


class Ended:
    """Stands for the process of a hand; its end of the line is the test's."""

    lines: ClassVar[list[Connection]] = []

    def __init__(self, target: object, args: tuple[Connection, ...], name: str) -> None:
        self.lines.append(Connection(os.dup(args[0].fileno())))

    def start(self) -> None:
        pass

    def join(self, timeout_s: float) -> None:
        pass

    def is_alive(self) -> bool:
        return False
