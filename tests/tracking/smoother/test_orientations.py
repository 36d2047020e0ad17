"""The 24 ways in which a sensor's axes can be exchanged against the file."""

import numpy as np

from tracking.smoother.orientations import right_angles


def test_there_are_24_ways_and_they_are_a_group() -> None:
    ways = right_angles()
    assert len(ways) == 24
    np.testing.assert_array_equal(ways[0], np.eye(3))
    np.testing.assert_allclose(np.linalg.det(ways), 1.0)
    known = {tuple(R.ravel()) for R in ways}
    assert len(known) == 24 and {tuple((a @ b).ravel()) for a in ways for b in ways} == known
