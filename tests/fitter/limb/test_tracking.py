"""Tracking of a known limb: angles, the base's pose, gaps, and what is said of the error."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.simulated_people.person import person, with_gaps, with_markers
from fitter.limb.tracking import track_limb


@pytest.fixture(scope="module")
def tracked():
    truth = person(n=400, noise_m=1e-3, seed=5)
    gappy = with_gaps(truth.recordings[0], np.random.default_rng(1))
    (found,) = track_limb(with_markers(truth), [gappy])
    return truth, found


def test_angles_are_found_through_gaps(tracked):
    truth, found = tracked
    away = np.degrees(np.abs(found.q - truth.q[0]))
    assert np.median(away) < 0.5
    assert np.quantile(away, 0.95) < 5.0
    assert np.nanmedian(found.distance_m) < 4e-3


def test_errors_hold_what_they_say(tracked):
    truth, found = tracked
    assert np.mean(np.abs(found.q - truth.q[0]) < 3.0 * found.q_std) > 0.95


def test_the_bases_pose_is_that_of_its_segment(tracked):
    truth, found = tracked
    np.testing.assert_allclose(np.linalg.norm(found.base[:, 3:], axis=1), 1.0, atol=1e-9)
    assert np.median(np.linalg.norm(found.base[:, :3] - truth.p[0], axis=1)) < 2e-3
    turned = Rotation.from_quat(found.base[:, [4, 5, 6, 3]]) * Rotation.from_matrix(truth.R[0]).inv()
    assert np.degrees(np.median(turned.magnitude())) < 1.5
