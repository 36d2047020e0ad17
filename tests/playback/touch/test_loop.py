"""The haptic loop tick by tick, by a clock that the test moves, on real sockets."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from playback.touch.device import TouchDevice
from playback.touch.holders import STALE_S
from playback.touch.limit import Coupling, sampled_interval, stiffness_limit
from playback.touch.loop import Setup, TouchLoop
from playback.touch.pace import Pace
from playback.touch.touched_arm import TouchedArm
from tests.patience import PATIENCE_MS

T = 1e-3
STIFF = Coupling(1e6, 1.0, 5.0, max_force=1e3)


class Driven:
    """A loop whose ticks are a test's to make."""

    def __init__(self, context, arm, coupling: Coupling) -> None:
        self.now_s = 10.0
        pace = Pace(T, lambda: self.now_s, self._sleep)
        setup = Setup(arm, (0.3, 0.6), 1.0 / T, coupling)
        self.loop = TouchLoop(context, setup, TouchedArm(arm, np.array(setup.q0), T, coupling), pace)

    def _sleep(self, seconds: float) -> None:
        self.now_s += seconds + 41e-6

    def tick(self, late_s: float = 0.0) -> None:
        self.now_s += late_s
        self.loop.tick(self.loop.pace.wait())

    def hear(self, device: TouchDevice, x) -> dict[str, object]:
        """Make the tick in which an input has come, and return its answer."""
        seq = device.send(x)
        assert self.loop._channel._socket.poll(PATIENCE_MS)
        self.tick()
        answer = device.wait(PATIENCE_MS)
        assert answer is not None
        assert answer["seq"] == seq
        return answer


@pytest.fixture
def driven(own_context) -> Iterator[Driven]:
    one = Driven(own_context, load_arm("dd-arm"), STIFF)
    yield one
    one.loop.close()


def test_the_coupling_is_as_stiff_as_the_rate_of_the_device_allows(driven: Driven, own_context) -> None:
    with TouchDevice(own_context, driven.loop.haptic) as device:
        tip = driven.loop.arm.touched_point(driven.loop.arm.tip)
        for _ in range(900):
            driven.hear(device, tip)
        fast = driven.loop.health()["stiffness_N_m"]
        assert fast == pytest.approx(stiffness_limit(5.0, 1.25, sampled_interval(T, T)), rel=0.02)
        for _ in range(150):
            driven.hear(device, tip)
            for _ in range(9):
                driven.tick()
        slow = driven.loop.health()["stiffness_N_m"]
        assert slow == pytest.approx(stiffness_limit(5.0, 1.25, sampled_interval(10 * T, T)), rel=0.1)


def test_without_an_input_for_20_ms_there_is_no_force_on_hand_or_arm(driven: Driven, own_context) -> None:
    with TouchDevice(own_context, driven.loop.haptic) as device:
        tip = driven.loop.arm.touched_point(driven.loop.arm.tip)
        for _ in range(300):
            driven.hear(device, tip + [0.0, 0.01, 0.0])
        work = driven.loop.arm.energy()["arm"]
        for _ in range(round(STALE_S / T) - 3):
            driven.tick()
        assert driven.loop.health()["connected"]
        for _ in range(4):
            driven.tick()
        health = driven.loop.health()
        assert (health["stale"], health["force_N"], health["energy_J"]["stored"]) == (True, 0.0, 0.0)
        work = driven.loop.arm.energy()["arm"]
        driven.tick()
        assert driven.loop.arm.energy()["arm"] == work


def test_a_late_tick_makes_up_for_those_it_missed_but_not_for_all_time(driven: Driven) -> None:
    driven.tick()
    driven.tick(late_s=5.3 * T)
    assert driven.loop.health()["overruns"] == 4
    driven.tick(late_s=1.0)
    assert driven.loop.health()["lost_steps"] > 900
    assert driven.loop.health()["lateness_ms"]["max"] > 900.0


def test_an_arm_that_runs_away_is_put_back(own_context) -> None:
    wild = replace(load_arm("dd-arm"), control=Control("pd", (-1e7, -1e7), (1e6, 1e6)))
    one = Driven(own_context, wild, Coupling())
    try:
        one.loop.arm.state[1] = 1.0
        for _ in range(3000):
            one.tick()
        assert one.loop.health()["resets"] > 0
        assert np.isfinite(one.loop.arm.felt).all()
    finally:
        one.loop.close()
