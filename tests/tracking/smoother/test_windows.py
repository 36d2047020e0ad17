"""A long recording is parted where it is calm, and tracked as if it had not been parted."""

import numpy as np
import pytest

from arm.model import Arm
from tests.tracking.smoother.test_discrepancy_smoother import RATE_HZ, case
from tracking.model.noise import Noise
from tracking.model.readings import Readings
from tracking.smoother import smoothed_frames
from tracking.smoother.smoothed_frames import SmoothedMotion, smooth_motion
from tracking.smoother.windows import LOOK_AHEAD_S, Window, _calmest, windows_of

#: Instants of a window in these tests: half a minute.
SHORT = 3000


def readings_of(values: np.ndarray) -> Readings:
    one = np.ones(values.shape[1])
    return Readings(values, 1.0 / RATE_HZ, 0.5, Noise(1e-4 * one, 0.0 * one), 1)


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


@pytest.mark.parametrize(
    ("scatters", "expected"),
    [
        *(
            (([9.0] * 3, [5.0] * 3, [7.0] * 3, [6.0] * 3, [1.0] * 3), 25),
            (([9.0] * 3, *[[8.0] * 3] * 2, [6.0] * 3), 75),
        ),
        *((([4.0, 4.0, 4.0], [5.0, 1.0, 0.0], [4.0, 3.0, 1.0]), 0), (([4.0, 4.0, 4.0], [1.0, 3.9, 1.0]), 25)),
    ],
)
def test_calmest_is_where_the_loudest_channel_scatters_least(scatters, expected):
    """Of the quarters of a second that begin within the first 100 frames; where channels stand says nothing."""
    here, there = np.arange(25) % 2 == 0, [[9.0] * 3] * (8 - len(scatters))
    parts = [np.where(here[:, None], 1.0, -1.0) * one + [0.0, 50.0, -80.0] for one in [*scatters, *there]]
    assert _calmest(np.vstack(parts), 76, 0.01) == expected


def test_calmest_in_gaps_is_the_first_that_was_read():
    values = np.full((200, 2), np.nan)
    assert _calmest(values, 50, 0.01) == 199
    values[60:] = np.random.default_rng(0).normal(size=(140, 2))
    assert _calmest(values, 50, 0.01) == 75
    values[20:50] = 9.0
    assert _calmest(values, 50, 0.01) == 25


@pytest.mark.parametrize(("n", "count"), [(4600, 1), (4601, 2)])
def test_a_fifth_and_what_lies_ahead_may_be_more(n, count):
    """Windows of 3000 frames to a fifth and ten seconds ahead of them."""
    windows = windows_of(readings_of(np.zeros((n, 3))), SHORT)
    assert len(windows) == count
    if count == 2:
        assert windows == [Window(0, 2400, 3400), Window(2400, n, n)]


def test_a_window_has_its_own_readings_on_the_same_clock():
    readings = readings_of(np.arange(300.0).reshape(100, 3))
    part = Window(20, 50, 70).of(readings)
    np.testing.assert_array_equal(part.values, readings.values[20:70])
    assert part.t0_s == pytest.approx(0.5 + 20 / RATE_HZ)


@pytest.fixture
def parted(monkeypatch: pytest.MonkeyPatch):
    """Return a function that smooths in windows of a given length [frames] with a given look-ahead [s]."""

    def smoothed(arm: Arm, readings: Readings, longest: int, ahead_s: float) -> SmoothedMotion:
        with monkeypatch.context() as patch:
            patch.setattr(smoothed_frames, "windows_of", lambda some: windows_of(some, longest, ahead_s))
            return smooth_motion(arm, readings, np.zeros(2))

    return smoothed


def test_in_windows_the_motion_is_that_of_the_whole(vertical_arm: Arm, parted) -> None:
    """The arm moves where one window ends and the next begins."""
    one = case(vertical_arm, 6, seconds=80.0)
    whole = smooth_motion(vertical_arm, one.readings, np.zeros(2))
    motion = parted(vertical_arm, one.readings, SHORT, 10.0)
    assert (len(whole.windows), len(motion.windows)) == (1, 3)
    assert whole.frames.q_std is not None and motion.frames.q_std is not None
    assert np.max(np.abs(motion.frames.q - whole.frames.q) / whole.frames.q_std) < 0.5
    assert np.abs(motion.frames.q_std / whole.frames.q_std - 1.0).max() < 0.1
    assert [phase.kind for phase in motion.phases] == [phase.kind for phase in whole.phases] == ["begin"]


def test_what_a_window_lacks_the_next_one_knows(vertical_arm: Arm, parted) -> None:
    one = case(vertical_arm, 6, lack=0.3, seconds=9.0)
    motion = parted(vertical_arm, one.readings, 400, 1.0)
    first, second = motion.windows
    assert first.discrepancy is not None and second.discrepancy is not None
    assert second.discrepancy.memory_s == first.discrepancy.memory_s
    assert np.mean(np.abs(motion.frames.q - one.q) < 3.0 * motion.frames.q_std) > 0.97


def test_of_several_windows_what_is_said_is_kept_and_no_motion(vertical_arm: Arm, parted) -> None:
    motion = parted(vertical_arm, case(vertical_arm, 6, seconds=9.0).readings, 400, 1.0)
    assert sum(motion.lengths) == len(motion.frames.q)
    for window in motion.windows:
        assert window.converged
        assert window.states.size == window.along.size == window.found.error.size == 0
