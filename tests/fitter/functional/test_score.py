"""Centres of joints against the equations written out and solved by scipy."""

import numpy as np
import pytest
import scipy.linalg

from fitter.functional.functional_centre import functional_centre
from tests.fitter.functional.poses import recorded, simulated, written_out

HIP = {
    "pelvis": ["LASI", "RASI", "LPSI", "RPSI"],
    "thigh_left": ["LTHI", "LKNE", "LF01", "LF02", "LF03", "LF04", "LF05"],
}
#: The issue's bound.
EQUAL_M = 1e-4


@pytest.mark.parametrize("seed", range(3))
def test_score_is_the_least_squares_answer(seed):
    _, parent, child = simulated("ball", seed, trials=2)
    centre = functional_centre("hip_right", parent, child)
    expected = scipy.linalg.lstsq(*written_out(parent, child))[0]
    assert np.allclose(np.concatenate([centre.in_parent_m, centre.in_child_m]), expected, atol=EQUAL_M / 1000)


def test_score_of_a_hip_is_the_least_squares_answer():
    hip = recorded("btk/FunctionalLHip.c3d", HIP)
    centre = functional_centre("hip_left", hip["pelvis"], hip["thigh_left"])
    expected = scipy.linalg.lstsq(*written_out(hip["pelvis"], hip["thigh_left"]))[0]
    assert np.allclose(np.concatenate([centre.in_parent_m, centre.in_child_m]), expected, atol=EQUAL_M / 1000)


@pytest.mark.parametrize("weighted", [False, True])
def test_without_skin_it_is_the_centre(weighted):
    limbs, parent, child = simulated("ball", 4, skin_m=0.0, skin_rad=0.0, noise_m=1e-5)
    centre = functional_centre("hip_right", parent, child, weighted=weighted)
    assert np.allclose(centre.in_parent_m, parent.place([limbs[0].p]), atol=2e-5)
    assert np.allclose(centre.in_child_m, child.place([limbs[0].p]), atol=2e-5)


def test_weights_help_where_markers_wander_independently():
    plain, weighted = [], []
    for seed in range(12):
        limbs, parent, child = simulated("ball", seed, 600, skin_m=0.0, skin_rad=0.0, noise_m=0.004)
        truth = parent.place([limbs[0].p])
        plain.append(functional_centre("hip_right", parent, child).in_parent_m - truth)
        weighted.append(functional_centre("hip_right", parent, child, weighted=True).in_parent_m - truth)
    assert np.mean(np.square(weighted)) < np.mean(np.square(plain))


def test_along_a_hinge_it_is_halfway_between_the_segments():
    limbs, parent, child = simulated("hinge", 5, skin_m=0.0, skin_rad=0.0)
    centre = functional_centre("knee_right", parent, child)
    assert list(centre.unobservable) == [True, False, False]
    axis = centre.turning.in_parent[0]
    middle = 0.5 * np.mean(parent.trials[0].to_segment(child.trials[0].p) @ axis)
    assert np.isclose(centre.in_parent_m @ axis, middle, atol=1e-4)
    off = centre.in_parent_m - parent.place([limbs[0].p])
    assert np.linalg.norm(off - axis * (off @ axis)) < 3e-4
