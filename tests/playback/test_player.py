"""Which frame is due when, by a clock that the test moves."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from arm.arm_file import format_arm
from arm.kinematics import sensor_positions, tip_position
from arm.model import Effect
from limbcal.errors import ConfigError
from playback.control_message import Request
from playback.export.sampled import sample
from playback.player import Player
from playback.playhead import Clocks
from playback.source import Source
from playback.trajectory import Trajectory

keep_fixtures = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


def drain(player: Player) -> list[dict[str, Any]]:
    frames = []
    while (frame := player.take_due()) is not None:
        frames.append(frame)
    return frames


@keep_fixtures
@given(rate_hz=st.floats(1.0, 200.0), trial=st.integers(1, 3), steps=st.lists(st.floats(0.0, 0.2), max_size=30))
def test_every_frame_comes_once_with_the_time_it_was_due_whatever_the_hold_ups(
    source: Source, rate_hz: float, trial: int, steps: list[float]
) -> None:
    now = [5.0]
    player = Player(source, rate_hz, Clocks(lambda: now[0], lambda: 10**18), trial)
    player.play()
    frames = []
    for step in [*steps, 10.0]:
        now[0] += step
        found = drain(player)
        assert all(frame["frame0"] / rate_hz <= now[0] - 5.0 + 1e-9 for frame in found)
        frames += found
    duration = source.durations_s[trial]
    assert [frame["frame0"] for frame in frames] == list(range(len(frames)))
    assert (len(frames) - 1) / rate_hz <= duration + 1e-6 / rate_hz
    assert len(frames) / rate_hz > duration
    assert [frame["t0_ns"] - 10**18 for frame in frames] == [round(k * 1e9 / rate_hz) for k in range(len(frames))]
    assert not player.playing
    assert player.finished == 1


def test_a_tip_is_that_of_an_arm_whose_zero_is_off(source: Source, fake_time: Any) -> None:
    off = replace(source.arm, effects=(Effect("joint_zero", {"offset_rad": 0.3}, (2,)),))
    player = Player(replace(source, arm=off), 80.0, fake_time.clocks, 1)
    player.play()
    (frame,) = drain(player)
    assert frame["tip"] == pytest.approx(tip_position(source.arm, frame["q"] + [0.0, 0.3]))
    assert frame["points"] == pytest.approx(sensor_positions(source.arm, frame["q"] + [0.0, 0.3]))
    overview: Any = player.carry_out(Request("motion", None))["motion"]
    assert overview["tip"] == pytest.approx(tip_position(source.arm, overview["q"] + [0.0, 0.3]))


def test_a_frame_says_what_the_trajectory_and_the_arm_say(source: Source, fake_time: Any) -> None:
    player = Player(source, 80.0, fake_time.clocks, 2)
    player.play()
    fake_time.now_s += 1.0
    frames = drain(player)
    t = np.arange(81) / 80.0
    motion, arm = source.load(2), source.arm
    q, dq, ddq = motion.at(t)
    known = {"q": q, "dq": dq, "ddq": ddq, "tip": tip_position(arm, q), "points": sensor_positions(arm, q)}
    for name, rows in known.items():
        np.testing.assert_array_equal(np.concatenate([frame[name] for frame in frames]), rows)
    plain = {"dt_s": 1 / 80, "n": 1, "method": "file", "gap": False, "source": "waves", "speed": 1.0}
    for frame in frames:
        assert {name: frame[name] for name in plain} == plain
        assert frame.keys() == known.keys() | plain.keys() | {"frame0", "t0_ns", "trial", "position_s"}


def test_play_stop_and_load_move_the_state(source: Source, fake_time: Any) -> None:
    player = Player(source, 100.0, fake_time.clocks)

    def state(*names: str) -> list[object]:
        return [player.state()[name] for name in names]

    assert state("playing", "trial", "position_s", "duration_s") == [False, 1, 0.0, 0.5]
    assert player.take_due() is None
    player.play()
    fake_time.now_s += 0.255
    assert len(drain(player)) == 26
    assert state("playing", "position_s") == [True, 0.25]
    player.play()  # what plays goes on
    assert state("position_s") == [0.25]
    player.stop()
    fake_time.now_s += 1.0
    assert player.take_due() is None
    assert state("playing", "position_s", "finished") == [False, 0.0, 0]
    player.play()
    player.load(3)
    assert state("playing", "trial", "duration_s") == [False, 3, 1.5]
    player.play()
    fake_time.now_s += 2.0
    assert len(drain(player)) == 151
    assert state("playing", "position_s", "finished") == [False, 1.5, 1]
    player.play()
    assert [frame["frame0"] for frame in drain(player)] == [0]


def test_a_trial_that_is_not_there_leaves_what_plays_alone(source: Source, fake_time: Any) -> None:
    player = Player(source, 100.0, fake_time.clocks, 2)
    player.play()
    before = player.state()
    with pytest.raises(ConfigError, match="there is no trial 9, expected one of 1, 2, 3"):
        player.load(9)
    assert player.state() == before


def test_frames_that_bridge_lost_samples_say_so(source: Source, fake_time: Any) -> None:
    t = np.array([0.0, 0.1, 0.2, 0.5, 0.6])
    x = np.zeros((5, 2))
    holed = Trajectory(t, x, x, x, "integrate", np.array([False, False, False, True, False]))
    player = Player(Source("holed", source.arm, {1: 0.6}, lambda _: holed), 10.0, fake_time.clocks)
    player.play()
    fake_time.now_s += 1.0
    assert [frame["gap"] for frame in drain(player)] == [False] * 3 + [True] * 3 + [False]


def test_between_its_nodes_no_motion_goes_beyond_the_joints_limits(arm, fake_time: Any) -> None:
    t = np.array([0.0, 1.0])
    q, dq = np.array([[0.9, 0.0], [0.9, 0.0]]), np.array([[2.0, 0.0], [-2.0, 0.0]])
    swing = Trajectory(t, q, dq, np.zeros((2, 2)), "file")
    joint = replace(arm.joints[0], limits=(-1.0, 1.0))
    frames = []
    for moving in (arm, replace(arm, joints=(joint, arm.joints[1]))):
        player = Player(Source("swing", moving, {1: 1.0}, lambda _: swing), 50.0, fake_time.clocks)
        player.play()
        fake_time.now_s += 2.0
        frames.append(np.concatenate([frame["q"] for frame in drain(player)])[:, 0])
    assert frames[0].max() > 1.2
    np.testing.assert_array_equal(frames[1], np.minimum(frames[0], 1.0))


def test_what_was_measured_beyond_a_limit_is_played_and_told_alike(arm, fake_time: Any) -> None:
    t = np.linspace(0.0, 1.0, 11)
    q = np.column_stack([-1.0 - 0.2 * np.sin(np.pi * t), t])
    beyond = Trajectory(t, q, np.gradient(q, t, axis=0), np.zeros((11, 2)), "file")
    limited = replace(arm, joints=(replace(arm.joints[0], limits=(-1.0, 1.0)), arm.joints[1]))
    source = Source("beyond", limited, {1: 1.0}, lambda _: beyond)
    player = Player(source, 10.0, fake_time.clocks)
    player.play()
    fake_time.now_s += 2.0
    np.testing.assert_allclose(np.concatenate([frame["q"] for frame in drain(player)]), q, atol=1e-12)
    player.carry_out(Request("seek", 0.5))
    assert player.state()["q"] == pytest.approx([-1.2, 0.5])
    np.testing.assert_allclose(sample(source, 1, 10.0, 1.0).movers[0].q, q, atol=1e-12)


@pytest.mark.parametrize(
    ("rate_hz", "rows"), [(100.0, 51), (4.0, 3), (3.0, 2), (1.0, 2), (3998.0, 2000), (4000.0, 2000), (1e5, 2000)]
)
def test_an_overview_has_a_row_a_frame_up_to_two_thousand(
    source: Source, fake_time: Any, rate_hz: float, rows: int
) -> None:
    player = Player(source, rate_hz, fake_time.clocks)
    motion: Any = player.carry_out(Request("motion", None))["motion"]
    np.testing.assert_allclose(motion["t"], np.linspace(0.0, 0.5, rows))
    np.testing.assert_array_equal(motion["q"], source.load(1).at(motion["t"])[0])
    np.testing.assert_array_equal(motion["tip"], tip_position(source.arm, motion["q"]))
    assert motion["twin_q"] is None and motion["twin_tip"] is None


def test_a_twin_s_overview_and_frames_are_its_own(source: Source, fake_time: Any) -> None:
    longer = source.arm.with_joints(a_m=np.array([0.5, 0.4]))
    other = Source("other", longer, source.durations_s, lambda _: source.load(2))
    player = Player(replace(source, twin=other), 100.0, fake_time.clocks, 1)
    motion: Any = player.carry_out(Request("motion", None))["motion"]
    q = source.load(2).at(motion["t"])[0]
    np.testing.assert_array_equal(motion["twin_q"], q)
    np.testing.assert_array_equal(motion["twin_tip"], tip_position(longer, q))
    player.play()
    frame: Any = player.take_due()
    assert frame["twin"]["name"] == "other"
    assert [len(frame["twin"][name]) for name in ("q", "dq", "ddq", "tip", "points")] == [1] * 5
    assert player.carry_out(Request("arm", None)) == {"arm": format_arm(source.arm), "twin": format_arm(longer)}


def test_the_whole_state_is_told(source: Source, fake_time: Any) -> None:
    player = Player(source, 80.0, fake_time.clocks, 2)
    assert player.state() == {
        **{"playing": False, "trial": 2, "position_s": 0.0, "duration_s": 1.0, "rate_hz": 80.0, "speed": 1.0},
        **{"loop": False, "source": "waves", "arm": source.arm.name, "twin": False, "live": False},
        **{"q": [0.0, 0.0], "trials": [1, 2, 3], "finished": 0},
    }
    assert (player.name, player.arm, player.waits_on, player.finished) == ("waves", source.arm, None, 0)
    assert player.carry_out(Request("arm", None)) == {"arm": format_arm(source.arm), "twin": None}


def test_every_request_is_carried_out(source: Source, fake_time: Any) -> None:
    player = Player(source, 10.0, fake_time.clocks)

    def after(cmd: Any, value: Any = None) -> tuple[bool, object, float, float, bool]:
        assert player.carry_out(Request(cmd, value)) == {}
        state, head = player.state(), player.head
        return head.playing, state["trial"], head.position_s, head.speed, head.loop

    assert after("seek", 0.2) == (False, 1, 0.2, 1.0, False)
    assert after("step", 2) == (False, 1, 0.4, 1.0, False)
    assert after("speed", 2.5) == (False, 1, 0.4, 2.5, False)
    assert after("loop", 1) == (False, 1, 0.4, 2.5, True)
    assert after("play") == (True, 1, 0.4, 2.5, True)
    assert after("pause") == (False, 1, 0.4, 2.5, True)
    assert after("load", 3) == (False, 3, 0.0, 2.5, True)
    assert after("loop", 0) == (False, 3, 0.0, 2.5, False)
    assert after("seek", 1.0) == (False, 3, 1.0, 2.5, False)
    assert after("stop") == (False, 3, 0.0, 2.5, False)
    lengths = [{"trial": trial, "duration_s": 0.5 * trial} for trial in (1, 2, 3)]
    assert player.carry_out(Request("list", None)) == {"trials": lengths}


def test_what_was_made_ahead_is_dropped_where_it_is_not_due(source: Source, fake_time: Any) -> None:
    player = Player(source, 100.0, fake_time.clocks, 3)
    player.prepare()  # nothing plays: nothing is made
    player.play()
    player.prepare()
    fake_time.now_s += 0.015
    assert [frame["position_s"] for frame in drain(player)] == [0.0, 0.01]
    player.head.seek(0.7)
    player.head.set_speed(2.0)
    fake_time.now_s += 0.02
    for frame in drain(player):
        np.testing.assert_array_equal(frame["q"], source.load(3).at(np.array([frame["position_s"]]))[0])
    assert (player.state()["position_s"], player.state()["speed"]) == (pytest.approx(0.72), 2.0)


@pytest.mark.parametrize(("speed", "gaps"), [(1.0, [3]), (2.0, [2]), (4.0, [1])])
def test_a_frame_answers_for_the_way_from_the_one_before(
    source: Source, fake_time: Any, speed: float, gaps: list[int]
) -> None:
    x = np.zeros((5, 2))
    lost = np.array([False, False, False, True, False])
    holed = Trajectory(np.array([0.0, 0.1, 0.21, 0.29, 0.8]), x, x, x, "integrate", lost)
    player = Player(Source("holed", source.arm, {1: 0.8}, lambda _: holed), 10.0, fake_time.clocks)
    player.head.set_speed(speed)
    player.play()
    fake_time.now_s += 1.0
    assert [k for k, frame in enumerate(drain(player)) if frame["gap"]] == gaps
