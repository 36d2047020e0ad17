"""Which joints move, by their speed."""

import numpy as np
import pytest

from fitter.data.standstill import REST_SPEED, is_moving, throughout


def test_a_degree_a_second_is_standstill_and_a_degree_and_a_half_is_not():
    assert not is_moving(np.deg2rad([1.0, -1.0])).any()
    assert is_moving(np.deg2rad([1.5, -1.5])).all()


def test_the_limit_itself_is_standstill_either_way():
    dq = np.array([[REST_SPEED, -REST_SPEED], [np.nextafter(REST_SPEED, 1.0), -np.nextafter(REST_SPEED, 1.0)]])
    assert is_moving(dq).tolist() == [[False, False], [True, True]]
    assert is_moving(dq, 0.0).all()
    assert not is_moving(np.zeros(3), 0.0).any()


@pytest.mark.parametrize("reach", [0, 1, 7])
def test_a_window_moves_if_all_its_samples_do(reach):
    moving = np.random.default_rng(0).random((300, 2)) < 0.9
    expected = [moving[max(0, k - reach) : k + reach + 1].all(axis=0) for k in range(len(moving))]
    assert np.array_equal(throughout(moving, reach), expected)
