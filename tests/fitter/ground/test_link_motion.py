"""Motion of a person's links against finite differences of their poses, on a base that moves too."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.moving_base import BaseState, standing_base
from benchmarks.simulated_people.ground import PERSON
from fitter.ground.link_motion import link_motions

STEP = 1e-4
G = np.array(PERSON.gravity_m_s2)


def central(x):
    return (x[2] - x[0]) / (2.0 * STEP), (x[2] - 2.0 * x[1] + x[0]) / STEP**2


@pytest.fixture(scope="module")
def moving():
    """Return motions at three times a step apart; the base turns about a fixed axis and slides."""
    rng = np.random.default_rng(0)
    q0, v, a = rng.normal(size=(3, PERSON.n_joint))
    s = STEP * np.arange(-1.0, 2.0)[:, None]
    q = q0 + s * v + 0.5 * s**2 * a
    axis, w, dw = np.array([0.6, 0.0, 0.8]), 1.3, -0.7
    R = Rotation.from_rotvec((w * s + 0.5 * dw * s**2) * axis).as_matrix()
    p, slide, push = rng.normal(size=(3, 3))
    base = BaseState(
        R, p + s * slide + 0.5 * s**2 * push, (w + s * dw) * axis,
        np.tile(dw * axis, (3, 1)), np.tile(push, (3, 1)),
    )  # fmt: skip
    return link_motions(PERSON, q, v + s * a, np.tile(a, (3, 1)), base)


def test_accelerations_are_the_second_differences_of_places(moving):
    for motion in moving:
        _, second = central(motion.o)
        np.testing.assert_allclose(motion.acceleration[1] + G, second, atol=2e-4, rtol=1e-5)


def test_turning_is_that_of_the_axes(moving):
    for motion in moving:
        first, _ = central(motion.R)
        W = first @ motion.R[1].T
        np.testing.assert_allclose(motion.omega[1], [W[2, 1], W[0, 2], W[1, 0]], atol=1e-5)
        faster, _ = central(motion.omega)
        np.testing.assert_allclose(motion.omega_dot[1], faster, atol=1e-5)


def test_a_person_who_stands_reads_gravity_alone():
    still = np.zeros((2, PERSON.n_joint))
    for motion in link_motions(PERSON, still, still, still, standing_base(2)):
        np.testing.assert_allclose(motion.acceleration, np.tile(-G, (2, 1)), atol=1e-12)
        np.testing.assert_array_equal(motion.omega, 0.0)
