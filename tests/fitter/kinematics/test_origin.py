"""Where displacements are counted from."""

from dataclasses import replace

import numpy as np

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.data.first_rest import displacement
from fitter.data.trial import Trial
from fitter.kinematics.origin import choose_about, counted_from_rest, rest_of

ARM = load_arm("dd-arm")


def resting_first(std, tip_std=0.0, rest=2000, seed=0):
    rng = np.random.default_rng(seed)
    angle = np.concatenate([np.zeros(rest), 1.0 - np.cos(np.linspace(0.0, 6.0, 3000))])
    q = np.column_stack([angle, 0.5 + angle])
    tip = tip_position(ARM, q) + tip_std * rng.normal(size=(len(q), 3))
    noisy = q + std * rng.normal(size=q.shape)
    return Trial("r", np.arange(len(q)) * 0.01, 0.01, noisy, np.gradient(noisy, 0.01, axis=0), 0 * q, tip=tip)


def test_the_rest_of_exact_angles_is_where_they_do_not_move(bench_trials):
    assert choose_about(bench_trials, np.zeros(2)) == "rest"
    for moved, expected in zip(
        counted_from_rest(ARM, bench_trials[0], np.zeros(2)), displacement(ARM, bench_trials[0]), strict=True
    ):
        assert np.array_equal(moved, expected)
    assert choose_about([replace(bench_trials[0], dq=np.ones_like(bench_trials[0].dq))], np.zeros(2)) == "mean"


def test_the_rest_of_noisy_angles_is_judged_by_the_angles():
    noise = np.full(2, 0.05)
    trial = resting_first(noise)
    rest = rest_of(trial, noise)
    assert 1200 < rest.stop <= 3000
    moved, at_rest = counted_from_rest(ARM, trial, noise)
    assert len(at_rest) == rest.stop
    assert np.allclose(moved[rest].mean(axis=0), 0.0, atol=1e-12)
    assert choose_about([trial], noise) == "rest"


def test_a_rest_that_is_too_short_for_its_noise_is_none():
    noise = np.full(2, 0.2)
    assert rest_of(resting_first(noise), noise) is None
    assert choose_about([resting_first(noise)], noise) == "mean"
    assert choose_about([resting_first(np.zeros(2), tip_std=0.5)], np.zeros(2)) == "mean"  # nor for the tip's


def test_samples_one_by_one_have_no_rest_and_recordings_always():
    trial = resting_first(np.zeros(2))
    assert choose_about([trial], None) == "mean"
    recorded = replace(trial, points=np.zeros((len(trial.q), 4, 3)))
    assert choose_about([recorded], None) == "rest"
    assert choose_about([recorded, trial], None) == "mean"
