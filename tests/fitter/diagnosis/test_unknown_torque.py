"""Torques that nobody knows do not pass for physics."""

import numpy as np
import pytest

from fitter.diagnosis.unknown_torque import jump_shapes


def test_an_impulse_lies_between_two_samples_and_keeps_its_size():
    shapes = jump_shapes([(3.25, 1, 0.4), (0.0, 0, 1.0)], 8, 2)
    assert shapes.shape == (8, 2, 2)
    assert shapes[3:5, 1, 0] == pytest.approx([0.3, 0.1])
    assert shapes[0, 0, 1] == 1.0
    np.testing.assert_allclose(shapes.sum(axis=(0, 1)), [0.4, 1.0])


def test_no_jump_no_shape():
    assert jump_shapes([], 8, 2).shape == (8, 2, 0)
