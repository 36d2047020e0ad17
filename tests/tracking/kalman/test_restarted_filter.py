"""A way of moving that is supposed is followed to the last of the readings that it explains."""

import numpy as np
import pytest

from tracking.kalman.restarted_filter import RestartedFilter
from tracking.model.noise import noise_of
from tracking.model.zero_velocity import window_frames

RATE_HZ, FACTOR = 4000.0, 4
DT_S = FACTOR / RATE_HZ


@pytest.mark.parametrize("n", [1, 8, 33])
def test_what_is_supposed_in_the_middle_is_predicted_to_the_end(level_bench, n):
    cell, n_cell = window_frames(DT_S)
    first = level_bench.readings[: FACTOR * cell * n_cell : FACTOR]
    noise = noise_of(level_bench.readings[:1000], RATE_HZ)
    rival = RestartedFilter(level_bench.arm, np.zeros(2), True, first, noise, FACTOR, DT_S)
    rival.regain(first[:n])
    at = rival.x.copy()
    at[[1, 4]] = 0.7, -1.2
    middle, misfit = rival.explained(first[:n], at)
    rival.suppose(first[:n], at)
    after_s = (n // 2) * DT_S
    q, dq, ddq = middle[0:6:3], middle[1:6:3], middle[2:6:3]
    assert rival.x[0:6:3] == pytest.approx(q + after_s * dq + 0.5 * after_s**2 * ddq, abs=1e-9)
    assert rival.x[1:6:3] == pytest.approx(dq + after_s * ddq, abs=1e-9)
    assert rival.misfit == pytest.approx(misfit)
