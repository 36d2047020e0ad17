"""Axes of joints against the equations written out and decomposed by scipy."""

import numpy as np
import pytest
import scipy.linalg

from fitter.functional.functional_axis import functional_axis
from tests.fitter.functional.poses import recorded, simulated, written_out

KNEE = {
    "thigh_right": ["RTHI1", "RTHI2", "RTHI3", "RGT"],
    "shank_right": ["RLEG1", "RLEG2", "RLEG3", "RATT"],
    "epicondyles": ["RLFE", "RMFE", "RGT"],
}
#: The issue's bound: 0.1° [rad].
EQUAL_RAD = np.radians(0.1)


def angle(a, b):
    return np.arcsin(min(1.0, np.linalg.norm(np.cross(a, b))))


def expected_axis(parent, child):
    A = written_out(parent, child)[0]
    last = scipy.linalg.svd(A, full_matrices=False)[2][-1]
    return last[:3] / np.linalg.norm(last[:3]), last[3:] / np.linalg.norm(last[3:])


@pytest.mark.parametrize("seed", range(3))
def test_sara_is_the_last_singular_vector(seed):
    _, parent, child = simulated("hinge", seed, trials=2)
    axis = functional_axis("knee_right", parent, child)
    for found, expected in zip((axis.in_parent, axis.in_child), expected_axis(parent, child), strict=True):
        assert angle(found, expected) < EQUAL_RAD / 1000


def test_sara_of_a_knee_is_the_last_singular_vector_and_near_the_epicondyles():
    knee = recorded("biobuddy/right_knee.c3d", KNEE)
    axis = functional_axis("knee_right", knee["thigh_right"], knee["shank_right"])
    expected = expected_axis(knee["thigh_right"], knee["shank_right"])[0]
    assert angle(axis.in_parent, expected) < EQUAL_RAD / 1000
    points = knee["epicondyles"].trials[0]
    world = points.residual_m + knee["epicondyles"].template.points_m
    line = [knee["thigh_right"].place([np.einsum("nij,nj->ni", points.R, world[:, i]) + points.p]) for i in (0, 1)]
    between = (line[0] - line[1]) / np.linalg.norm(line[0] - line[1])
    assert np.degrees(angle(axis.in_parent, between)) < 12.0


def test_without_skin_it_is_the_axis():
    limbs, parent, child = simulated("hinge", 6, skin_m=0.0, skin_rad=0.0, noise_m=1e-5)
    axis = functional_axis("knee_right", parent, child)
    in_parent = np.einsum("nji,nj->ni", parent.trials[0].R, limbs[0].R[:, :, 2])
    assert angle(axis.in_parent, in_parent[0]) < 1e-4
    off = axis.point_in_parent_m - parent.place([limbs[0].p])
    assert np.linalg.norm(np.cross(off, axis.in_parent)) < 5e-5
