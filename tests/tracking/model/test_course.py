"""Readings as a course of which nothing more is known."""

import numpy as np

from tracking.model.course import course_of
from tracking.model.noise import Noise
from tracking.model.readings import Readings

NAN = np.nan


def test_a_course_of_which_nothing_is_known():
    """White noise of a mean of four, and no less than 1e-6 of one; rounding is in every reading alike."""
    values = np.arange(12.0).reshape(4, 3)
    values[2] = NAN
    noise = Noise(np.array([4e-4, 8e-4, 0.0]), np.array([1e-6, 0.0, 3e-6]), 1e-6)
    course = course_of(Readings(values, 0.004, 0.0, noise, 4), 2)
    assert course.dt == 0.004
    np.testing.assert_array_equal(
        course.readings, [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [0.0] * 3, [9.0, 10.0, 11.0]]
    )
    np.testing.assert_array_equal(course.present, [True, True, False, True])
    np.testing.assert_allclose(course.noise, [1.01e-4, 2e-4, 3.25e-6], rtol=1e-12)
    np.testing.assert_allclose(course.wander, [4e-10 + 1e-6, 4e-10, 4e-10 + 3e-6], rtol=1e-12)
    np.testing.assert_array_equal(course.push, [9.0, 9.0])  # 3 rad/s^2 in a second
    np.testing.assert_allclose(course.jolt, [[0.0] * 2, [0.0] * 2, [2500.0 * 0.004] * 2, [0.0] * 2])
    np.testing.assert_array_equal(course.doubt, np.ones((4, 3)))
    np.testing.assert_array_equal(course.rate, np.zeros(2))
    np.testing.assert_array_equal(course.rest, np.zeros((4, 2)))


def test_readings_that_lie_column_by_column_are_laid_out_row_by_row():
    """Kernels are compiled for one layout."""
    values = np.asfortranarray(np.arange(12.0).reshape(4, 3))
    course = course_of(Readings(values, 0.004, 0.0, Noise(np.full(3, 1e-4), np.zeros(3)), 4), 2)
    assert course.readings.flags.c_contiguous
    np.testing.assert_array_equal(course.readings, values)
