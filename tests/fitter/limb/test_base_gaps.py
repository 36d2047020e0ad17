"""A base that is not seen is as far from the limb's markers as before, and its orientation goes on evenly."""

import numpy as np
from scipy.spatial.transform import Rotation

from fitter.limb.base_gaps import carried_along, interpolated


def test_an_orientation_is_interpolated_and_kept_at_the_ends():
    R, p = np.full((5, 3, 3), np.nan), np.full((5, 3), np.nan)
    R[[1, 3]] = Rotation.from_rotvec([[0.0, 0.0, 0.2], [0.0, 0.0, 0.6]]).as_matrix()
    p[[1, 3]] = [[0.0, 0.0, 0.0], [0.4, 0.0, 0.2]]
    turned, place = interpolated(R, p)
    np.testing.assert_allclose(Rotation.from_matrix(turned).as_rotvec()[:, 2], [0.2, 0.2, 0.4, 0.6, 0.6])
    np.testing.assert_allclose(place[:, 0], [0.0, 0.0, 0.2, 0.4, 0.4])


def test_one_pose_alone_is_kept():
    R, p = np.full((3, 3, 3), np.nan), np.full((3, 3), np.nan)
    R[1], p[1] = np.eye(3), 1.0
    turned, place = interpolated(R, p)
    np.testing.assert_array_equal(turned, np.tile(np.eye(3), (3, 1, 1)))
    np.testing.assert_array_equal(place, np.ones((3, 3)))


def test_a_hidden_base_goes_where_the_markers_go():
    t = np.arange(40.0)
    way = np.column_stack([0.05 * t, 0.002 * t**2, 0.0 * t])
    y = way[:, None] + np.array([[0.1, 0.0, 0.0], [0.0, 0.3, 0.0], [0.2, 0.1, 0.5]])
    y[15:20] = np.nan  # nothing is seen: a straight line
    y[25, 1:] = np.nan
    known = (t < 10) | (t == 22)
    found = carried_along(y, known, np.where(known[:, None], way, np.nan))
    seen = np.isfinite(y[..., 0]).any(axis=1)
    np.testing.assert_allclose(found[seen], way[seen], atol=1e-12)
    line = np.linspace(way[14], way[20], 7)[1:-1]
    np.testing.assert_allclose(found[15:20], line, atol=1e-12)


def test_a_marker_that_was_never_seen_beside_the_base_says_nothing_of_it():
    way = np.zeros((10, 3))
    y = np.full((10, 2, 3), np.nan)
    y[:, 0], y[5:, 1] = 1.0, 7.0
    known = np.arange(10) < 5
    np.testing.assert_allclose(carried_along(y, known, way), way)
