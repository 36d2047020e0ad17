"""Rest from the readings alone."""

import numpy as np
import pytest

from tracking.dead_reckoning.rest import RestDetector
from tracking.dead_reckoning.rest_cell import WINDOW

STEP = 1.5e-3
#: Two sensors on one link: their difference is judged strictly.
CONTRAST = np.hstack([-np.eye(3), np.eye(3)])


def detector(slack=0.0):
    return RestDetector(CONTRAST, np.full(6, slack))


def cells(values, n_cell, noise=0.02, seed=0, n=320):
    """Return cells of readings around constant values, rounded as a converter does."""
    rng = np.random.default_rng(seed)
    read = np.asarray(values) + noise * rng.standard_normal((n_cell, n, 6))
    return np.rint(read / STEP) * STEP


def judged(judge, readings, pinned=False):
    return [judge.judge(cell, np.zeros(6), pinned) for cell in readings]


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.02, 0.2])
def test_rest_is_rest_however_noisy(noise):
    for seed in range(5):
        assert all(judged(detector(), cells([0.3, 0.1, 9.8] * 2, 600, noise, seed)))


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_push_is_seen_at_once_and_rest_after_a_window(noise):
    judge = detector()
    judged(judge, cells(np.zeros(6), 50, noise))
    assert judged(judge, cells([0.1, 0, 0, 0.2, 0, 0], 3, noise, 1)) == [False] * 3
    after = judged(judge, cells(np.zeros(6), 60, noise, 2))
    assert after == [False] * (WINDOW - 1) + [True] * (61 - WINDOW)


def test_a_slow_start_is_seen_within_a_window():
    """Too weak for a single cell, but not for 25 of them."""
    judge = detector()
    judged(judge, cells(np.zeros(6), 400))
    pushed = judged(judge, cells([0.006, 0, 0, 0.012, 0, 0], 60, seed=1))
    assert pushed[0] and False in pushed[:WINDOW]


def test_acceleration_that_passes_through_zero_is_no_rest():
    """At the turning point of a brake the mean is small, but there is a trend."""
    judge = detector()
    judged(judge, cells(np.zeros(6), 50))
    judged(judge, cells([0.5, 0, 0, 0.8, 0, 0], 5, seed=1))
    ramp = np.linspace(-0.06, 0.06, 101)
    passing = [cells([x, 0, 0, 2 * x, 0, 0], 1, seed=k)[0] for k, x in enumerate(ramp)]
    assert not any(judged(judge, passing))


def test_the_offset_is_what_is_read_beyond_gravity():
    judge, bias = detector(), np.array([0.02, -0.03, 0.01, 0.0, 0.05, -0.01])
    gravity = np.array([0.0, 0.0, 9.8] * 2)
    for cell in cells(gravity + bias, 200):
        judge.judge(cell, gravity, False)
    np.testing.assert_allclose(judge.offset, bias, rtol=0, atol=3e-4)


def test_a_pinned_offset_is_learnt_in_the_first_quarter_second_only():
    judge, free = detector(), detector()
    for each, pinned in ((judge, True), (free, False)):
        judged(each, cells(np.zeros(6), WINDOW), pinned)
        judged(each, cells([0.001] * 6, 300, seed=1), pinned)
    assert np.abs(judge.offset).max() < 4e-4
    assert free.offset.min() > 7e-4


def test_gravity_may_excuse_what_the_angles_drifted_but_not_what_two_sensors_say():
    readings = {
        "both alike": ([0.2, 0, 0, 0.2, 0, 0], True),
        "each its own": ([0.2, 0, 0, 0.1, 0, 0], False),
        "too much": ([0.5, 0, 0, 0.5, 0, 0], False),
    }
    for name, (reads, rests) in readings.items():
        judge = detector(slack=0.34)
        judged(judge, cells(np.zeros(6), 50))
        assert judged(judge, cells(reads, 30, seed=1))[-1] is rests, name
    strict = detector()
    judged(strict, cells(np.zeros(6), 50))
    assert not judged(strict, cells([0.2, 0, 0, 0.2, 0, 0], 30, seed=1))[-1]


def test_a_quiet_converter_may_round_gravity_anew_in_every_pose():
    """Without noise a reading is off by up to half a step, by another half in another pose."""
    judge = detector(slack=0.34)
    judged(judge, cells([0.49 * STEP] * 3 + [-0.49 * STEP] * 3, 50, noise=0.0))
    judged(judge, cells([0.5, 0, 0, 0.9, 0, 0], 3))
    other_pose = [0.1 + 0.6 * STEP] * 3 + [0.1 - 0.6 * STEP] * 3
    assert judged(judge, cells(other_pose, WINDOW, noise=0.0))[-1]


def test_after_a_gap_a_window_begins_anew():
    judge = detector()
    judged(judge, cells(np.zeros(6), 50))
    judged(judge, cells([0.1, 0, 0, 0.2, 0, 0], 3))
    judged(judge, cells(np.zeros(6), WINDOW - 1))
    judge.forget()
    assert judged(judge, cells(np.zeros(6), WINDOW)) == [False] * (WINDOW - 1) + [True]


def test_the_first_quarter_second_is_taken_on_trust():
    judge = detector()
    assert judged(judge, cells([1.0] * 6, WINDOW)) == [True] * WINDOW
    np.testing.assert_allclose(judge.offset, 1.0, rtol=0, atol=1e-3)


def test_cells_of_two_readings_show_their_noise():
    judge = detector()
    assert all(judged(judge, cells(np.zeros(6), 400, n=2)))


def _creeping(judge):
    """Rest, then a motion that ends in a creep of twice what a rest may show."""
    judged(judge, cells(np.zeros(6), 100))
    judged(judge, cells([0.5, 0, 0, 0.8, 0, 0], 5, seed=1))
    return judged(judge, cells([0.0, 0, 0, 0.004, 0, 0], 60, seed=2))


def test_a_motion_that_begins_out_of_a_creep_is_noticed():
    judge = detector()
    assert not any(_creeping(judge))
    assert not judge.jolted
    judged(judge, cells([0.3, 0, 0, 0.6, 0, 0], 1, seed=3))
    assert judge.jolted
    judged(judge, cells([0.3, 0, 0, 0.6, 0, 0], 1, seed=4))
    assert not judge.jolted


def test_a_creep_that_grows_is_the_same_motion():
    judge = detector()
    _creeping(judge)
    for k, x in enumerate(np.linspace(0.004, 0.2, 200)):
        judged(judge, cells([x / 2, 0, 0, x, 0, 0], 1, seed=k))
        assert not judge.jolted
