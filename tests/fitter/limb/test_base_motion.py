"""Poses of a segment against those by which its markers were moved."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fitter.limb.base_motion import base_motion, markers_in, poses_of, require_standing
from fitter.limb.limb_trials import LimbTrials
from limbcal.errors import NotIdentifiable

POINTS = np.array([[0.1, 0.0, 0.0], [0.0, 0.12, 0.0], [-0.05, 0.0, 0.09], [0.02, -0.1, 0.04]])


def moved(points, n=20, seed=0):
    rng = np.random.default_rng(seed)
    R, p = Rotation.random(n, random_state=seed).as_matrix(), rng.normal(size=(n, 3))
    return np.einsum("nij,mj->nmi", R, points) + p[:, None], R, p


def test_of_three_markers_or_more_the_pose_is_that_of_the_motion():
    measured, R, p = moved(POINTS)
    found_R, found_p = poses_of(POINTS, measured)
    np.testing.assert_allclose(found_R, R, atol=1e-9)
    np.testing.assert_allclose(found_p, p, atol=1e-9)


def test_two_markers_give_the_mean_displacement_and_no_orientation():
    p = np.random.default_rng(1).normal(size=(10, 3))
    measured = POINTS[None, :2] + p[:, None]
    measured[3, 0] = np.nan
    measured[5] = np.nan
    R, found = poses_of(POINTS[:2], measured)
    seen = np.arange(10) != 5
    np.testing.assert_allclose(found[seen], p[seen], atol=1e-12)
    np.testing.assert_array_equal(R[seen], np.tile(np.eye(3), (9, 1, 1)))
    assert np.isnan(R[5]).all() and np.isnan(found[5]).all()


def test_without_markers_it_stands_at_the_origin():
    R, p = poses_of(np.zeros((0, 3)), np.zeros((4, 0, 3)))
    np.testing.assert_array_equal(R, np.tile(np.eye(3), (4, 1, 1)))
    np.testing.assert_array_equal(p, np.zeros((4, 3)))


def test_points_in_a_frame_are_carried_back_by_its_pose():
    measured, R, p = moved(POINTS, n=1, seed=3)
    np.testing.assert_allclose(markers_in(measured[0], R[0], p[0]), POINTS, atol=1e-12)


def a_thigh_that_goes(way_m):
    """Return trials of one marker on a thigh, which swings by 0.3 m and goes so far, and leaps away once."""
    t = np.linspace(0.0, 1.0, 200)
    y = np.column_stack([0.3 * np.sin(20.0 * t) + way_m * t, 0.0 * t, 0.0 * t])[:, None]
    y[7] = 30.0
    return LimbTrials(("KNE",), (y,), (t,), "+z", {"thigh_right": ("KNE",)}, {}, frozenset(), {}, ())


def test_a_base_without_markers_stands_where_the_limb_stays_within_its_reach():
    trials = a_thigh_that_goes(0.2)
    base = base_motion(trials, "pelvis")
    assert [note.kind for note in base.notes] == ["base_untracked"]
    require_standing(trials, base, "pelvis", "thigh_right", 0.43)


def test_a_base_without_markers_is_refused_where_the_limb_goes_away():
    trials = a_thigh_that_goes(3.0)
    with pytest.raises(NotIdentifiable, match="no marker of pelvis .* KNE on thigh_right goes 3"):
        require_standing(trials, base_motion(trials, "pelvis"), "pelvis", "thigh_right", 0.43)
