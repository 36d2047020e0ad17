"""The floor is what a model lacks: a white torque of a known size comes back, and exact data have none."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.diagnosis.error_floor import _freedom, _known, _likeliest, floored, part_of_floor, regression_of
from fitter.diagnosis.evidence import Floor
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from tests.fitter.diagnosis.searched import swinging
from tests.fitter.diagnosis.two_joints import regression_of_two


@pytest.fixture(scope="module")
def plain():
    return swinging()


@pytest.fixture(scope="module")
def plain_two():
    return regression_of_two()


def shaken(regression, size):
    """Return the equations of a run whose drives missed a white torque of so much a sample, (n_joint,)."""
    rng = np.random.default_rng(1)
    motions = [replace(one, u=one.u + size * rng.normal(size=one.u.shape)) for one in regression.motions]
    return regression_of(regression.arm, motions)


def floor_of(regression):
    return floored(regression, fitted(regression, Model()))


def weighed_twice(regression):
    """Return a run under weights with its floor: the residual under the sensors' weights leaks along the band."""
    for _ in range(2):
        own, weighted, floor = floor_of(regression)
        regression = regression.weighted_by(weighted)
        regression.sensors = own
    return regression, own, floor


@pytest.mark.parametrize("size", [0.05, 0.1, 1.0])
def test_a_white_missing_torque_is_found_with_its_size(plain, size):
    """But for what the base parameters take of it, and what holds a joint."""
    regression, own, floor = weighed_twice(shaken(plain, np.array([size])))
    assert floor.white == pytest.approx([size], rel=0.2)
    assert floor.is_large and not floor.is_none
    np.testing.assert_allclose(regression.weighting.torque_noise, np.hypot(own.torque_noise, floor.white))
    assert 0.1 < part_of_floor(own, regression.weighting) < 1.0


def test_every_joint_has_its_own(plain_two):
    _, _, floor = weighed_twice(shaken(plain_two, np.array([0.0, 0.2])))
    assert floor.white[1] == pytest.approx(0.2, rel=0.2)
    # The base parameters that both equations have are bent a little by what the other joint lacks.
    assert floor.white[0] < 0.25 * floor.white[1]


def test_weights_with_a_floor_come_to_the_same_again_and_leave_what_they_should(plain):
    regression, _, once = weighed_twice(shaken(plain, np.array([0.1])))
    _, _, again = floor_of(regression)
    for name in ("ratio", "white", "steep"):
        np.testing.assert_allclose(getattr(again, name), getattr(once, name), rtol=0.05)
    left = fitted(regression, Model()).squares / regression.n_effective
    assert 0.8 < left.mean() < 1.2


@pytest.mark.parametrize("run", ["plain", "plain_two"])
def test_exact_data_have_none(run, request):
    regression = request.getfixturevalue(run)
    own, weighted, floor = floor_of(regression)
    assert floor.is_none and not floor.is_large
    np.testing.assert_array_equal(floor.white, 0.0)
    np.testing.assert_array_equal(floor.steep, 1.0)
    np.testing.assert_array_equal(weighted.torque_noise, own.torque_noise)
    np.testing.assert_array_equal(weighted.acceleration_noise, own.acceleration_noise)
    assert part_of_floor(own, weighted) == 0.0


@given(st.floats(0.0, 10.0), st.floats(0.0, 10.0))
def test_what_is_plain_is_something(one, other):
    floor = Floor(np.array([one, other]), np.zeros(2), np.ones(2))
    assert not (floor.is_large and floor.is_none)


@given(st.integers(0, 1000), st.floats(0.1, 100.0), st.floats(1.5, 30.0))
@settings(max_examples=15, deadline=None, derandomize=True)
def test_both_parts_are_told_apart_by_their_colour(seed, white, steep):
    f = np.linspace(0.3, 15.0, 4000)
    torque, angle = 0.01, (f / 5.0) ** 4
    spectrum = torque + white + steep * angle
    power = spectrum * np.random.default_rng(seed).exponential(size=len(f))
    found = _likeliest(power, np.ones(len(f)), torque, angle)
    np.testing.assert_allclose(found, (white, steep), rtol=0.25)


def test_noise_that_is_left_where_joints_are_held_is_told_at_every_frequency(plain_two):
    """By draws of it: little is left of low frequencies where a joint rests, and all of high ones.

    Whatever held the joints: a torque there of any size changes nothing.
    """
    weighting, motion = plain_two.weighting, plain_two.learning[0]
    n, n_joint = -(-len(motion.t) // weighting.stride), motion.q.shape[1]
    rng = np.random.default_rng(5)
    draws, axes = rng.normal(size=(n * n_joint, 2000)), weighting.axes(motion)[0]
    held = axes @ rng.normal(size=(axes.shape[1], draws.shape[1]), scale=100.0)
    left = np.fft.rfft(_known(weighting, motion, draws + held).reshape(n, n_joint, -1), axis=0)
    power = left @ left.conj().mT / (n * draws.shape[1])
    freedom = _freedom(weighting, motion)
    np.testing.assert_allclose(freedom, power, atol=0.15)  # five standard errors
    of_joints = np.einsum("fjj->fj", freedom).real
    assert np.all(of_joints[1] < of_joints[-2])
