"""Torques that nobody knows do not pass for physics."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from fitter.diagnosis.whitening import end_weight, holding_shapes, jump_shapes


def test_an_impulse_lies_between_two_samples_and_keeps_its_size():
    shapes = jump_shapes([(3.25, 1, 0.4), (0.0, 0, 1.0)], 8, 2)
    assert shapes.shape == (8, 2, 2)
    assert shapes[3:5, 1, 0] == pytest.approx([0.3, 0.1])
    assert shapes[0, 0, 1] == 1.0
    np.testing.assert_allclose(shapes.sum(axis=(0, 1)), [0.4, 1.0])


def test_no_jump_no_shape():
    assert jump_shapes([], 8, 2).shape == (8, 2, 0)


@pytest.mark.parametrize("first", range(4, 20, 4))
def test_friction_that_jumps_somewhere_in_a_short_rest_is_followed(first):
    """A joint turns round within 40 ms: when, nobody sees, nor where its friction changed sides."""
    dt_s, begin, end = 0.002, 200, 220
    stuck = np.zeros(400, dtype=np.bool_)
    stuck[begin:end] = True
    k = np.arange(400)
    torque = np.where(k < begin + first, -1.0, 1.0) * stuck * end_weight(400, dt_s)
    shapes = holding_shapes(stuck, dt_s)
    slow = gaussian_filter1d(np.column_stack([torque, shapes]), 5.0, axis=0)  # 15 Hz, as the filter's band
    left = slow[:, 0] - slow[:, 1:] @ np.linalg.lstsq(slow[:, 1:], slow[:, 0], rcond=1e-9)[0]
    assert np.linalg.norm(left) < 0.05 * np.linalg.norm(slow[:, 0])
