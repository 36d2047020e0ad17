"""Trials on the run's clock, and where a joint is stuck."""

import numpy as np

from fitter.data.trials import to_trials
from fitter.diagnosis.cutoff import white_noise
from fitter.diagnosis.run import run_of
from fitter.diagnosis.whitening import end_weight, holding_shapes, lasting
from tests.fitter.pendulum import pendulum, swings


def test_trials_whose_clocks_start_anew_follow_one_another():
    trials = to_trials(swings((), trials=3), cutoff_hz=25.0)
    run = run_of(pendulum(), trials[:2], trials[2:])
    starts = [motion.t[0] for motion in run]
    np.testing.assert_allclose(np.diff(starts), 3.0, atol=0.01)
    assert [motion.number for motion in run] == [1, 2, 3]
    assert [motion.learn for motion in run] == [True, True, False]


def test_white_noise_is_told_from_motion():
    rng = np.random.default_rng(0)
    t = np.arange(5000)[:, None] * 0.002
    noisy = np.sin(3.0 * t) + 2e-4 * rng.normal(size=t.shape)
    assert abs(white_noise([noisy])[0] - 2e-4) < 1e-5


def test_what_passes_through_zero_is_not_stuck():
    stuck = np.zeros((500, 1), dtype=bool)
    stuck[100:104], stuck[200:300] = True, True
    kept = lasting(stuck, 0.002)[:, 0]
    assert not kept[100:104].any()
    assert kept[200:300].all()


def test_holding_torques_can_follow_any_slow_torque_while_stuck():
    stuck = np.zeros(1000, dtype=bool)
    stuck[300:700] = True
    shapes = holding_shapes(stuck, 0.002)
    t = np.arange(1000) * 0.002
    torque = np.where(stuck, np.sin(4.0 * t), 0.0)
    left = torque - shapes @ np.linalg.lstsq(shapes, torque, rcond=None)[0]
    assert np.abs(left).max() < 0.03


def test_the_weight_vanishes_at_both_ends():
    weight = end_weight(500, 0.002)
    assert weight[0] < 0.01 > weight[-1]
    np.testing.assert_array_equal(weight[100:400], 1.0)
