"""A trial on the grid of a file."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions, tip_position
from limbcal.errors import ConfigError
from playback.export.sampled import sample
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
