"""The haptic loop tick by tick, by a clock that the test moves, on real sockets."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from playback.touch.device import TouchDevice
from playback.touch.holders import STALE_S
from playback.touch.limit import Coupling, sampled_interval, stiffness_limit
from playback.touch.loop import Setup, TouchLoop
from playback.touch.message import Command
from playback.touch.pace import Pace
from playback.touch.touched_arm import TouchedArm
from protocol.message import HEALTH, PLAY
from protocol.publisher import Publisher
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


def test_whoever_held_an_arm_that_was_reset_takes_hold_anew(driven: Driven, own_context) -> None:
    """A device that is slower than the loop is not heard in the tick after the command."""
    with TouchDevice(own_context, driven.loop.haptic) as device:
        tip = driven.loop.arm.touched_point(driven.loop.arm.tip)
        for _ in range(300):
            driven.hear(device, tip)
        driven.loop._carry_out(Command("reset"))
        for _ in range(3):
            driven.tick()
        assert not driven.loop.health()["connected"]
        forces = [np.linalg.norm(driven.hear(device, tip + [0.0, 0.01, 0.0])["force"]) for _ in range(250)]
        assert driven.loop.health()["connected"]
        assert forces[0] < 0.05 * max(forces) and max(forces) > 1.0
        assert np.isfinite(list(driven.loop.health()["energy_J"].values())).all()


def test_a_device_that_is_left_alone_with_the_arm_takes_hold_of_it(driven: Driven, own_context) -> None:
    haptic = driven.loop.haptic
    with TouchDevice(own_context, haptic) as first, TouchDevice(own_context, haptic) as second:
        tip = driven.loop.arm.touched_point(driven.loop.arm.tip)
        elsewhere = tip + [0.3, 0.0, 0.0]
        driven.hear(first, elsewhere)
        for k in range(300):
            assert driven.hear(second, tip)["holds"]
            if k % 5 == 0:
                assert not driven.hear(first, elsewhere)["holds"]
        felt = []
        driven.tick()
        driven.tick()
        while driven.loop.pace.ticks < 400:  # now the first is heard alone, in every fifth tick
            answer = driven.hear(first, elsewhere)
            felt += [np.linalg.norm(answer["force"])] if answer["holds"] else []
            for _ in range(4):
                driven.tick()
        assert felt[0] < 0.01 * 0.3 * driven.loop.health()["stiffness_N_m"]  # a hand far off is no blow


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


def test_no_hand_feels_an_arm_that_runs_away(own_context) -> None:
    """With these gains velocities overflow in the force before they do in the arm."""
    wild = replace(load_arm("dd-arm"), control=Control("pd", (400.0, 400.0), (-3167.85, -3167.85)))
    one = Driven(own_context, wild, Coupling())
    try:
        with TouchDevice(own_context, one.loop.haptic) as device:
            place = one.loop.arm.touched_point(one.loop.arm.tip) + [0.0, 0.02, 0.0]
            for _ in range(30):
                assert np.isfinite(one.hear(device, place)["force"]).all()
        assert one.loop.health()["resets"] > 0
    finally:
        one.loop.close()


def test_a_loop_that_has_just_begun_says_so(driven: Driven) -> None:
    health = driven.loop.health()
    assert {name: health[name] for name in BEGUN} == BEGUN
    assert health["energy_J"]["passive"] is True
    assert health["lateness_ms"] == health["step_us"] == {"p50": None, "p99": None, "max": None}


BEGUN = {
    **{"uptime_s": 0.0, "last_seq": {}, "rate_hz": 1000.0, "held_rate_hz": 0.0, "ticks": 0, "overruns": 0},
    **{"lost_steps": 0, "interval_ms": 1.0, "inputs": 0, "resets": 0, "devices": 0, "connected": False},
    **{"stale": True, "force_N": 0.0, "real_time": False, "damping_N_s_m": 1.25, "wall_stiffness_N_m": 0.0},
    "stiffness_N_m": pytest.approx(stiffness_limit(5.0, 1.25, T)),
}


def test_a_hundred_frames_a_second_are_sent_and_a_heartbeat(
    driven: Driven, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[tuple[str, dict[str, object], int]] = []
    ticks = [0]
    monkeypatch.setattr(
        Publisher, "publish", lambda _self, topic, fields: sent.append((topic, dict(fields), ticks[0]))
    )
    for k in range(2050):
        ticks[0] = k
        driven.tick()
    frames = [(fields["frame0"], tick) for topic, fields, tick in sent if topic == PLAY]
    beats = [(fields["ticks"], tick) for topic, fields, tick in sent if topic == HEALTH]
    assert [number for number, _ in frames] == list(range(len(frames)))
    assert len(frames) == 206  # that of the beginning, and one each 10 ms
    assert all(abs(tick - 10 * number) <= 1 for number, tick in frames)
    assert len(beats) == 3 and beats[0][1] <= 1  # at the beginning and after each second
    assert [tick for _, tick in beats[1:]] == [pytest.approx(1000, abs=2), pytest.approx(2000, abs=2)]
    assert len({tick for *_, tick in sent}) == len(sent)  # never two in one tick


def test_where_nobody_says_which_link_it_is_the_tip_s(driven: Driven, own_context) -> None:
    with TouchDevice(own_context, driven.loop.haptic) as device:
        arm = driven.loop.arm
        answer = driven.hear(device, arm.touched_point(arm.tip))
        assert answer["holds"] is True and answer["stale"] is False
        assert answer["q"] == pytest.approx([0.3, 0.6], abs=1e-3) and answer["dq"] == pytest.approx(
            [0, 0], abs=0.1
        )
        assert answer["point"] == pytest.approx(arm.touched_point(arm.tip).tolist())
        health = driven.loop.health()
        assert (health["inputs"], health["devices"], health["connected"], health["stale"]) == (1, 1, True, False)


@pytest.mark.parametrize(
    ("command", "does"),
    [
        (Command("state"), []),
        (Command("hold", np.array([0.1, 0.2])), [("hold", [0.1, 0.2])]),
        (Command("free"), [("free", None)]),
        (Command("reset", np.array([0.5, -0.5])), [("reset", [0.5, -0.5])]),
        (Command("reset"), [("reset", [0.3, 0.6])]),  # where it is
    ],
)
def test_a_command_does_what_it_says_and_nothing_else(
    driven: Driven, monkeypatch: pytest.MonkeyPatch, command: Command, does: list[tuple[str, list[float] | None]]
) -> None:
    done: list[tuple[str, list[float] | None]] = []

    def note(name: str, q: np.ndarray | None = None) -> None:
        done.append((name, None if q is None else np.asarray(q).tolist()))

    for name in ("hold", "free", "reset"):
        monkeypatch.setattr(driven.loop.arm, name, partial(note, name))
    driven.loop._carry_out(command)
    assert done == does
