"""A trial on the grid of a file."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions, tip_position
from arm.model import Arm, Effect, Joint
from limbcal.errors import ConfigError, DataError
from playback.export.sampled import sample
from playback.shape import REAL, TWIN
from playback.source import Source
from playback.trajectory import Trajectory
from tests.playback.export.conftest import source_of

SOURCE = source_of(load_arm("dd-arm"), twin=True)


@pytest.mark.parametrize(("rate_hz", "speed", "n_frame"), [(60.0, 1.0, 31), (100.0, 2.0, 26), (7.0, 0.5, 8)])
def test_the_grid_is_even_and_the_speed_a_factor(rate_hz: float, speed: float, n_frame: int) -> None:
    made = sample(SOURCE, 1, rate_hz, speed)
    assert len(made.t) == n_frame
    assert made.t == pytest.approx(np.arange(n_frame) / rate_hz)
    q, dq, ddq = SOURCE.load(1).at(made.t * speed)
    real, twin = made.movers
    assert np.array_equal(real.q, q)
    assert real.dq == pytest.approx(speed * dq)
    assert real.ddq == pytest.approx(speed**2 * ddq)
    assert np.array_equal(real.tip, tip_position(real.arm, q))
    assert np.array_equal(real.points, sensor_positions(real.arm, q))
    assert twin.q == pytest.approx(q * 5 / 6, abs=1e-12)
    assert (real.name, twin.name) == ("dd-arm", "dd-arm (twin)")


def test_a_trial_is_the_one_asked_for() -> None:
    assert sample(SOURCE, None, 60.0, 1.0).trial == 1
    assert sample(SOURCE, 4, 60.0, 1.0).duration_s == pytest.approx(0.3)
    with pytest.raises(ConfigError, match="there is no trial 2, expected one of 1, 4"):
        sample(SOURCE, 2, 60.0, 1.0)


@pytest.mark.parametrize("speed", [1e-9, 1e-320])
def test_frames_without_end_are_refused(speed: float) -> None:
    with pytest.raises(ConfigError, match="expected at most 3600000: a lower --rate-hz or a higher --speed"):
        sample(SOURCE, 1, 60.0, speed)


@pytest.mark.parametrize("rate_hz", [1.0, 3.0, 60.0])
def test_keys_of_a_fast_turn_lie_close_enough_to_turn_the_right_way(rate_hz: float) -> None:
    t = np.linspace(0.0, 2.0, 201)
    turns = 12.0 * np.pi * t / 2.0  # six turns
    q = np.column_stack([turns, 0.1 * t])
    dq = np.gradient(q, t, axis=0)
    arm = load_arm("dd-arm")
    source = Source("turning", arm, {1: 2.0}, lambda _: Trajectory(t, q, dq, np.zeros_like(q), method="file"))
    keys = sample(source, None, rate_hz, 1.0, 0.5 * np.pi)
    steps = np.diff(keys.movers[0].q[:, 0])
    assert steps.max() <= 0.5 * np.pi + 1e-9 and steps.sum() == pytest.approx(12.0 * np.pi)
    frames = np.arange(int(2.0 * rate_hz) + 1) / rate_hz
    assert all(np.abs(keys.t - frame).min() < 1e-12 for frame in frames)
    with pytest.raises(DataError, match="are its angles in degrees"):
        fast = Trajectory(t, 1e6 * q, 1e6 * dq, np.zeros_like(q), method="file")
        sample(Source("wild", arm, {1: 2.0}, lambda _: fast), None, rate_hz, 1.0, 0.5 * np.pi)


def turning(t: np.ndarray, *columns: np.ndarray) -> Source:
    """Return a motion through these nodes, on joints of which the last slides."""
    q = np.column_stack(columns)
    dq = np.gradient(q, t, axis=0)
    joints = (*(Joint(a_m=0.1) for _ in columns[1:]), Joint("prismatic"))
    moving = Trajectory(t, q, dq, np.zeros_like(q), method="file")
    return Source("turning", Arm("one", joints), {1: float(t[-1])}, lambda _: moving)


def test_keys_are_added_evenly_and_only_where_a_joint_turns_too_far() -> None:
    t = np.linspace(0.0, 3.0, 301)
    angle = np.where(t < 1.0, 0.0, np.where(t < 2.0, 3.5 * (t - 1.0), 3.5))
    keys = sample(turning(t, angle, 100.0 * t), None, 1.0, 1.0, 0.9)  # how far one slides does not count
    assert keys.t == pytest.approx([0.0, 1.0, 1.25, 1.5, 1.75, 2.0, 3.0])
    assert keys.duration_s == pytest.approx(3.0)
    just = sample(turning(t, t, 0.0 * t), None, 1.0, 1.0, 1.0 + 1e-9)
    assert just.t == pytest.approx([0.0, 1.0, 2.0, 3.0])
    twice = sample(turning(t, 0.4 * t, 0.8 * t, 0.0 * t), None, 1.0, 2.0, 1.0)  # the joint that turns farther
    assert twice.t == pytest.approx([0.0, 0.5, 1.0])
    alone = sample(turning(t, t, 0.0 * t), None, 0.1, 1.0, 1e-3)
    assert alone.t.tolist() == [0.0]


@pytest.mark.parametrize(("most", "fits"), [(6, True), (5, False)])
def test_keys_are_counted(monkeypatch: pytest.MonkeyPatch, most: int, fits: bool) -> None:
    monkeypatch.setattr("playback.export.sampled.MOST_KEYS", most)
    t = np.linspace(0.0, 1.0, 101)
    wheel = turning(t, 2.0 * np.pi * t, 0.0 * t)
    if fits:
        assert len(sample(wheel, None, 1.0, 1.0, 1.1).t) == 7  # six parts of a turn
        return
    with pytest.raises(DataError, match="turning: a joint makes 1 turns, which takes more than 5 keys"):
        sample(wheel, None, 1.0, 1.0, 1.1)


def test_an_arm_stands_where_its_zeros_say_and_has_a_name_of_its_own() -> None:
    off = replace(load_arm("dd-arm"), effects=(Effect("joint_zero", {"offset_rad": 0.3}, (2,)),))
    real, twin = sample(source_of(off, twin=True), None, 60.0, 1.0).movers
    assert (real.name, twin.name, real.colours, twin.colours) == ("dd-arm", "dd-arm (twin)", REAL, TWIN)
    assert real.arm is off
    assert real.tip == pytest.approx(tip_position(load_arm("dd-arm"), real.q + [0.0, 0.3]))
    assert real.points == pytest.approx(sensor_positions(load_arm("dd-arm"), real.q + [0.0, 0.3]))
