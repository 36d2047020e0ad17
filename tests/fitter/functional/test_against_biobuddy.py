"""SCoRE and SARA of measured joints against an independent implementation, biobuddy's, where it is installed."""

import numpy as np
import pytest

from fitter.functional.functional_axis import functional_axis
from fitter.functional.functional_centre import functional_centre
from tests.fitter.functional.poses import recorded
from tests.fitter.functional.test_sara import EQUAL_RAD, KNEE, angle
from tests.fitter.functional.test_score import EQUAL_M, HIP


def theirs(motion):
    """Return a segment's poses as biobuddy has them."""
    algebra = pytest.importorskip("biobuddy.utils.linear_algebra", exc_type=ImportError)
    poses = motion.trials[0]
    rt = np.zeros((4, 4, len(poses.p)))
    rt[:3, :3], rt[:3, 3], rt[3, 3] = np.moveaxis(poses.R, 0, -1), poses.p.T, 1.0
    return algebra.RotoTransMatrixTimeSeries.from_rt_matrix(rt)


def tools():
    return pytest.importorskip("biobuddy.model_modifiers.joint_center_tool", exc_type=ImportError)


def test_a_hips_centre_is_theirs():
    hip = recorded("btk/FunctionalLHip.c3d", HIP)
    parent, child = theirs(hip["pelvis"]), theirs(hip["thigh_left"])
    found = tools().Score.perform_algorithm(parent, child, recursive_outlier_removal=False)
    centre = functional_centre("hip_left", hip["pelvis"], hip["thigh_left"])
    np.testing.assert_allclose(centre.in_parent_m, found[1], atol=EQUAL_M)
    np.testing.assert_allclose(centre.in_child_m, found[2], atol=EQUAL_M)


def test_a_knees_axis_is_theirs():
    knee = recorded("biobuddy/right_knee.c3d", KNEE)
    parent, child = theirs(knee["thigh_right"]), theirs(knee["shank_right"])
    found = tools().Sara.perform_algorithm(parent, child, recursive_outlier_removal=False)
    axis = functional_axis("knee_right", knee["thigh_right"], knee["shank_right"])
    assert angle(axis.in_parent, found[1]) < EQUAL_RAD
    assert angle(axis.in_child, found[2]) < EQUAL_RAD
