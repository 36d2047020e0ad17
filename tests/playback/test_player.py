"""Which frame is due when, by a clock that the test moves."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from arm.kinematics import sensor_positions, tip_position
from limbcal.errors import ConfigError
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
