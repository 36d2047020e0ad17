"""How far up columns are looked at follows the motion, and not its noise."""

import numpy as np
import pytest

from fitter.data.motions import Measured
from fitter.data.resample import Uniform
from fitter.diagnosis.corner import CORNER_HZ, corner_hz


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
