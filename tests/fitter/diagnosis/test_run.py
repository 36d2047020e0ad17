"""Velocities behind filters, and the noise that these leave."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from fitter.data.motions import Measured
from fitter.data.trial import Trial
from fitter.data.trials import to_trials
from fitter.diagnosis.run import run_of, sharper, sharper_gain, significant_velocity, velocity, velocity_gain
from fitter.diagnosis.whitening import STUCK_S
from tests.fitter.pendulum import pendulum, swings

NOISE = 2e-4


@pytest.mark.parametrize("dt_s", [0.0005, 0.002, 0.01])
def test_the_noise_of_a_velocity_is_what_its_filters_leave(dt_s: float) -> None:
    rng = np.random.default_rng(0)
    width = max(0.006, 1.5 * dt_s) / dt_s
    angle = 1e-4 * rng.normal(size=(200_000, 1))
    slopes = gaussian_filter1d(angle, width, axis=0, order=1) / dt_s
    assert np.std(sharper(slopes, dt_s)) == pytest.approx(1e-4 * sharper_gain(dt_s), rel=0.03)


def trial_of(q: np.ndarray, dt_s: float, seed: int = 0) -> Trial:
    """Return a trial of one joint with these angles and noise."""
    some = to_trials(swings((), trials=1), cutoff_hz=25.0)[0]
    noisy = q[:, None] + NOISE * np.random.default_rng(seed).normal(size=(len(q), 1))
    t = np.arange(len(q)) * dt_s
    return replace(some, t=t, dt_s=dt_s, q=noisy, dq=np.zeros_like(noisy), whole={"q": noisy}, trimmed=0)


def significant(q: np.ndarray, dt_s: float) -> tuple[np.ndarray, np.ndarray]:
    seen, noise = significant_velocity(trial_of(q, dt_s), np.array([NOISE]), np.array([1e-4]))
    return seen[:, 0], noise[:, 0]


def test_slow_motion_that_the_narrow_filter_hides_is_seen():
    dt_s, speed = 0.002, 0.015
    assert speed < 4.0 * NOISE * velocity_gain(dt_s)
    q = speed * np.arange(4000) * dt_s
    seen, noise = significant(q, dt_s)
    inner = slice(100, -100)
    assert np.mean(seen[inner] > 0.0) > 0.99
    off = seen[inner] - speed
    assert np.std(off) == pytest.approx(np.median(noise[inner]), rel=0.2)
    assert abs(off.mean()) < 0.05 * speed  # no choice by noise


def test_rest_stays_rest():
    seen, _ = significant(np.zeros(20_000), 0.002)
    assert np.mean(seen != 0.0) < 2e-3


def test_a_reversal_is_never_taken_for_motion_the_other_way():
    dt_s = 0.002
    t = np.arange(5000) * dt_s
    seen, _ = significant(0.05 * np.sin(2.0 * t), dt_s)
    true = 0.1 * np.cos(2.0 * t)
    wrong = (np.sign(seen) == -np.sign(true)) & (np.abs(true) > 1e-3)
    assert not wrong[100:-100].any()


@pytest.mark.parametrize("times", [1.0, 2.0, 4.0])
def test_the_gain_of_a_wider_filter(times):
    trial = trial_of(np.zeros(100_000), 0.002)
    assert np.std(velocity(trial, times)) == pytest.approx(NOISE * velocity_gain(0.002, times), rel=0.05)


def reversing(rest_s: float) -> np.ndarray:
    """Return angles of a joint that brakes at 40 rad/s^2, rests, and goes back at 35 rad/s^2."""
    t = np.arange(1000) * 0.002 - 1.0
    before, after = np.minimum(t, 0.0), np.maximum(t - rest_s, 0.0)
    return -20.0 * np.clip(before, -0.1, 0.0) ** 2 - 17.5 * np.clip(after, 0.0, 0.1) ** 2


def longest_rest_s(q: np.ndarray) -> float:
    around = significant(q, 0.002)[0][460:540] == 0.0
    edges = np.flatnonzero(np.diff(np.concatenate([[False], around, [False]]).astype(np.int8)))
    return 0.002 * float(np.max(edges[1::2] - edges[::2], initial=0))


@pytest.mark.parametrize("rest_s", [0.016, 0.022, 0.04])
def test_a_short_rest_that_the_filter_fills_is_seen(rest_s: float) -> None:
    assert longest_rest_s(reversing(rest_s)) > max(STUCK_S, rest_s - 0.012)


def test_a_joint_that_only_turns_round_does_not_rest() -> None:
    assert longest_rest_s(reversing(0.0)) < STUCK_S


def test_a_joint_that_creeps_never_goes_back_for_a_sample():
    """Where noise hides it for less than a rest, it goes on as it did."""
    t, rng = np.arange(40_000) * 0.002, np.random.default_rng(0)
    columns = {"q": 0.006 * t[:, None] + NOISE * rng.normal(size=(len(t), 1)), "tau": np.zeros((len(t), 1))}
    (trial,) = to_trials([Measured("creep", "test", 0, t, columns)], cutoff_hz=25.0)
    motion = run_of(pendulum(), [trial], [])[0]
    assert np.mean(motion.direction == 1.0) > 0.5
    assert not np.any(motion.direction < 0.0)
