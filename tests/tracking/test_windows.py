"""A long recording is parted where it is calm, and tracked as if it had not been parted."""

import numpy as np
import pytest

from arm.model import Arm
from tests.tracking.test_discrepancy_smoother import RATE_HZ, case
from tracking import smoothed_frames
from tracking.noise import Noise
from tracking.readings import Readings
from tracking.smoothed_frames import SmoothedMotion, smooth_motion
from tracking.windows import LOOK_AHEAD_S, Window, windows_of

#: Instants of a window in these tests: half a minute.
SHORT = 3000


def readings_of(values: np.ndarray) -> Readings:
    one = np.ones(values.shape[1])
    return Readings(values, 1.0 / RATE_HZ, 0.5, Noise(1e-4 * one, 0.0 * one), 1)


def in_windows(
    arm: Arm, readings: Readings, monkeypatch: pytest.MonkeyPatch
) -> tuple[SmoothedMotion, SmoothedMotion]:
    """Return a motion smoothed whole, and in windows."""
    whole = smooth_motion(arm, readings, np.zeros(2))
    monkeypatch.setattr(smoothed_frames, "windows_of", lambda some: windows_of(some, SHORT))
    return whole, smooth_motion(arm, readings, np.zeros(2))


def test_a_recording_that_is_not_much_longer_than_a_window_is_one():
    n = round(1.2 * SHORT + LOOK_AHEAD_S * RATE_HZ)
    assert windows_of(readings_of(np.zeros((n, 3))), SHORT) == [Window(0, n, n)]


def test_windows_follow_each_other_and_end_where_readings_change_least():
    rng = np.random.default_rng(1)
    values = rng.normal(size=(5 * SHORT, 3))
    calm = slice(2800, 2950)
    values[calm] *= 1e-3
    windows = windows_of(readings_of(values), SHORT)
    assert calm.start <= windows[0].end < calm.stop
    assert [one.end for one in windows[:-1]] == [one.begin for one in windows[1:]]
    assert (windows[0].begin, windows[-1].end) == (0, len(values))
    for one in windows[:-1]:
        assert 0.8 * SHORT <= one.end - one.begin <= 1.2 * SHORT
        assert one.ahead == min(one.end + LOOK_AHEAD_S * RATE_HZ, len(values))


def test_no_window_begins_in_a_gap():
    values = np.random.default_rng(2).normal(size=(3 * SHORT, 3))
    values[2300:3700] = np.nan
    end = windows_of(readings_of(values), SHORT)[0].end
    assert np.isfinite(values[end : end + 25]).all() and end >= 3700


def test_a_window_has_its_own_readings_on_the_same_clock():
    readings = readings_of(np.arange(300.0).reshape(100, 3))
    part = Window(20, 50, 70).of(readings)
    np.testing.assert_array_equal(part.values, readings.values[20:70])
    assert part.t0_s == pytest.approx(0.5 + 20 / RATE_HZ)


@pytest.mark.parametrize(("lack", "apart_std"), [(0.0, 0.5), (0.3, 1.5)])  # each window learns what is lacking
def test_in_windows_the_motion_is_that_of_the_whole(
    vertical_arm: Arm, lack: float, apart_std: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever is moving where one window ends and the next begins."""
    one = case(vertical_arm, 6, lack=lack, seconds=80.0)
    whole, parted = in_windows(vertical_arm, one.readings, monkeypatch)
    assert len(whole.windows) == 1 and len(parted.windows) == 3
    std = whole.frames.q_std
    assert std is not None and parted.frames.q_std is not None
    assert np.max(np.abs(parted.frames.q - whole.frames.q) / std) < apart_std
    assert np.abs(parted.frames.q_std / std - 1.0).max() < 0.5
    assert np.mean(np.abs(parted.frames.q - one.q) < 3.0 * parted.frames.q_std) > 0.97
    assert [phase.kind for phase in parted.phases] == [phase.kind for phase in whole.phases]


def test_of_several_windows_what_is_said_is_kept_and_no_motion(
    vertical_arm: Arm, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, parted = in_windows(vertical_arm, case(vertical_arm, 6, seconds=80.0).readings, monkeypatch)
    assert sum(parted.lengths) == len(parted.frames.q)
    assert all(window.converged for window in parted.windows)
    assert all(
        window.states.size == window.along.size == window.found.error.size == 0 for window in parted.windows
    )
