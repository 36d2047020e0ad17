"""How far up columns are looked at follows the motion, and not its noise."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.model import Arm, Joint
from fitter.data.derivatives import lowpass
from fitter.data.motions import Measured
from fitter.data.resample import Uniform
from fitter.data.trial_filter import choose_cutoff_hz
from fitter.diagnosis.cutoff import BAND_SHARE, CORNER_HZ, chatter, corner_hz, white_noise


def grids(swings_hz: list[float], dt_s: float = 0.002, noise: float = 2e-4) -> list[Uniform]:
    """Return two trials in which joints swing this quickly, each by 0.3 rad/s."""
    rng = np.random.default_rng(0)
    t = np.arange(round(4.0 / dt_s)) * dt_s
    rate = 2.0 * np.pi * np.array(swings_hz)
    found = []
    for phase in (0.0, 1.0):
        q = 0.3 / rate * np.sin(np.outer(t, rate) + phase) + noise * rng.normal(size=(len(t), len(rate)))
        found.append(Uniform(Measured("some", "test", 0, t, {"q": q}), dt_s, 0.0))
    return found


def test_slow_motion_is_cut_off_where_all_is():
    assert corner_hz(grids([0.7, 4.0])) == CORNER_HZ


def test_a_loop_that_swings_fast_is_seen_with_its_overtones():
    assert corner_hz(grids([1.0, 24.0])) == pytest.approx(72.0, rel=0.05)


def test_a_joint_that_rests_says_nothing():
    resting = grids([1.0, 24.0])
    for grid in resting:
        grid.measured.columns["q"][:, 1] = 2e-4 * np.random.default_rng(1).normal(size=len(grid.measured.t))
    assert corner_hz(resting) == CORNER_HZ


@pytest.mark.parametrize(("dt_s", "most"), [(0.01, 20.0), (0.005, 40.0)])
def test_sampling_allows_no_more(dt_s, most):
    assert corner_hz(grids([24.0], dt_s)) == pytest.approx(most)


def averaged(column, samples):
    """Return the mean of some samples in a row."""
    return np.convolve(column, np.full(samples, 1.0 / samples), "same")


def drawn_straight(column, samples):
    """Return every few samples with straight lines between them, as a log of a higher rate than its sensor has."""
    k = np.arange(len(column))
    return np.interp(k, k[::samples], column[::samples])


def shaken(column, size):
    """Return a column to which a mount adds what shakes it, below some 30 Hz."""
    return column + size * lowpass(np.random.default_rng(5).normal(size=column.shape), 0.002, 30.0)


@pytest.mark.parametrize(
    ("made", "by"), [(averaged, 2), (averaged, 3), (drawn_straight, 2), (drawn_straight, 3), (shaken, 5e-4)]
)
def test_of_noise_that_is_not_white_no_more_is_looked_at_than_what_stands_out(made, by):
    """It is not what third differences tell of it."""
    recorded = grids([0.7, 4.0])
    for grid in recorded:
        q = grid.measured.columns["q"]
        q[:] = np.stack([made(column, by) for column in q.T], axis=1)
    assert corner_hz(recorded) == pytest.approx(choose_cutoff_hz(recorded) / BAND_SHARE)
    assert 8.0 < corner_hz(recorded) < 0.6 * CORNER_HZ


@given(st.floats(1e-6, 1e-3), st.sampled_from([0.001, 0.002, 0.004]))
@settings(max_examples=15, deadline=None)
def test_white_noise_of_any_size_is_understood(noise, dt_s):
    assert corner_hz(grids([0.7, 4.0], dt_s, noise)) == CORNER_HZ


ARM = Arm("two", (Joint(a_m=0.3), Joint(type="prismatic")))
T = np.arange(2000) * 0.002


def trial(noise):
    smooth = np.sin(np.outer(T, [3.0, 5.0]))
    white = np.random.default_rng(0).normal(size=smooth.shape)
    return SimpleNamespace(whole={"tau": smooth + noise * white})


def test_every_joint_is_asked_and_has_its_unit():
    (sentence,) = chatter(ARM, [trial(np.array([0.0, 2.0]))])
    assert sentence.startswith("the torque at joint 2 changes from sample to sample like noise")
    assert "N of" in sentence and "N m" not in sentence
    (other,) = chatter(ARM, [trial(np.array([2.0, 0.0]))])
    assert "joint 1" in other and "N m rms" in other


def test_smooth_torques_and_none_are_not():
    assert chatter(ARM, [trial(np.array([0.1, 0.1]))]) == []
    assert chatter(ARM, [SimpleNamespace(whole={})]) == []


def test_a_coarse_step_is_noise_where_samples_repeat():
    """A uniform error within a step; most third differences of such a column are zero."""
    step_rad, t = 1.5e-3, np.arange(0.0, 4.0, 1e-3)
    q = step_rad * np.round(0.1 * np.sin(t) / step_rad)
    assert white_noise([q[:, None]]) == pytest.approx([step_rad / np.sqrt(12.0)])
    assert white_noise([np.ones((50, 1))]) == [0.0]
