"""Draws of a motion's errors scatter as the smoother says, and as the errors do."""

import numpy as np
import pytest

from arm.kinematics import sensor_positions
from tracking.model.draws import DRAWS, Draws
from tracking.model.expected_readings import room_of
from tracking.smoother.linear_response import respond
from tracking.smoother.motion_follower import MotionFollower, _creep
from tracking.smoother.smoother import Smoother, release

RATE_HZ = 250.0


@pytest.fixture(scope="module")
def readings(level_bench, decimated):
    return decimated(level_bench, RATE_HZ)


@pytest.fixture(scope="module")
def followed(level_bench, readings):
    follower = MotionFollower(level_bench.arm, 0, (3,))
    return follower.follow(readings, level_bench.q[0], None, level_bench.q[-1])


def test_a_draw_of_what_was_given_and_read_scatters_as_the_smoother_claims(level_bench, readings):
    smoother = Smoother(level_bench.arm, level_bench.q[0], True)
    found = smoother.smooth(readings)
    course, rng, draws = found.course, np.random.default_rng(1), 400
    errors = np.linalg.cholesky(found.before + 1e-18 * np.eye(smoother.size)) @ rng.standard_normal(
        (smoother.size, draws)
    )
    n, n_channel = course.readings.shape
    noise = rng.standard_normal((n, n_channel + 2, draws))
    noise[:, :n_channel] *= np.sqrt(course.noise)[:, None]
    noise[:, n_channel:] *= np.sqrt(course.rest)[:, :, None]
    response = np.empty((n, 6, draws))
    P = found.before.copy()
    respond(smoother.observation, room_of(2), course, found.along, P, errors, noise, response)
    np.testing.assert_allclose(P, found.covariance, rtol=1e-6, atol=1e-15)
    share = (response**2).mean(axis=2)[50:-50] / found.variance[50:-50]
    # What a prior on the motion claims beyond the readings is not in the draws.
    assert 0.5 < np.median(share[:, ::3]) < 1.3
    assert 0.5 < np.median(share[:, 1::3]) < 1.3


def test_errors_are_of_the_size_of_the_draws(level_bench, readings, followed):
    at = readings.t0_s + readings.dt_s * np.arange(len(readings.values))
    q = np.column_stack([np.interp(at, level_bench.t, level_bench.q[:, j]) for j in range(2)])
    std = np.sqrt(((followed.draws.q - followed.q) ** 2).mean(axis=0))
    share = ((followed.q - q) / std)[100:]
    assert np.sqrt(np.mean(share**2)) < 3.0
    assert followed.draws.q.shape == (DRAWS, *q.shape)
    assert followed.draws.points.shape == (DRAWS, len(q), 1, 3)


def test_velocities_and_paths_are_off_by_what_their_draws_scatter(level_bench, readings, followed):
    at = readings.t0_s + readings.dt_s * np.arange(len(readings.values))
    q, dq = (
        np.column_stack([np.interp(at, level_bench.t, c) for c in of.T]) for of in (level_bench.q, level_bench.dq)
    )
    draws = followed.draws
    std = np.sqrt(((draws.dq - followed.dq) ** 2).mean(axis=0))
    assert 0.2 < np.sqrt(np.mean(((followed.dq - dq) / std)[100:] ** 2)) < 3.0
    true = sensor_positions(level_bench.arm, q)
    beginning = slice(0, 800)  # paths of accelerometers drift away
    off = (followed.points - (true - true[0]))[beginning]
    scatter = np.sqrt(np.mean((draws.points[:, :, 0] - followed.points[:, 3])[:, beginning] ** 2))
    assert np.abs(off).max() < 0.05
    assert 0.2 < np.sqrt(np.mean(off[:, 3] ** 2)) / scatter < 3.0


def test_the_same_seed_gives_the_same_draws(level_bench, readings, followed):
    again = MotionFollower(level_bench.arm, 0, (3,)).follow(readings, level_bench.q[0], None, level_bench.q[-1])
    np.testing.assert_array_equal(again.draws.points, followed.draws.points)


def test_a_motion_begins_with_what_the_one_before_it_left(level_bench, readings):
    follower = MotionFollower(level_bench.arm, 0, (3,))
    first = follower.follow(readings, level_bench.q[0], None, level_bench.q[0])
    end = first.draws.q[:, -1] - first.q[-1]
    second = follower.follow(readings, level_bench.q[0], None, level_bench.q[0])
    begun = second.draws.q[:, 0] - second.q[0]
    # Not quite one and the same: what the second motion tells of its beginning is taken in.
    assert np.corrcoef(end[:, 0], begun[:, 0])[0, 1] > 0.5


def test_an_arm_is_let_go_of_before_it_is_seen_to_move(level_bench, readings):
    smoother = Smoother(level_bench.arm, level_bench.q[0], True)
    course = smoother.smooth(readings).course
    still = np.zeros(len(course.readings), dtype=bool)
    still[:100], course.rest[:] = True, still[:, None]
    release(course, still)
    assert still[:60].all() and not still[70:].any()
    np.testing.assert_array_equal(course.rest[:, 0] > 0.0, still)


def test_gravity_corrects_where_an_arm_was_thought_to_rest(upright_bench, decimated):
    """What a tracker says is a guess, unless it says how well it knows it."""
    readings = decimated(upright_bench, RATE_HZ)
    said = upright_bench.q[0] + [0.1, -0.05]
    found = MotionFollower(upright_bench.arm, 0, (3,)).follow(readings, said, None, upright_bench.q[-1])
    assert np.abs(found.q[0] - upright_bench.q[0]).max() < 0.01


def test_drawn_points_stand_still_while_the_arm_rests(followed):
    """Where its joints crept before a motion, its points have that speed until the motion's end, and no longer."""
    still = followed.still
    rests = still[1:] & still[:-1]
    assert rests[0] and rests.sum() > 100
    moved = np.abs(np.diff(followed.draws.points, axis=1))
    np.testing.assert_allclose(moved[:, rests], 0.0, rtol=0, atol=1e-12)
    assert moved[:, ~rests].max() > 1e-3


@pytest.mark.parametrize("rests_again", [True, False])
def test_points_leave_a_rest_as_fast_as_joints_crept_there_until_the_next(level_bench, rests_again):
    still = np.zeros(12, dtype=bool)
    still[:4], still[9:] = True, rests_again
    q, dq = np.array([0.3, -0.8]), np.array([0.02, -0.03])
    drawn = Draws(*(np.tile(one, (3, 12, 1)) for one in (q, dq, 0.0 * q)), np.zeros((3, 12, 4, 3)))
    _creep(level_bench.arm, drawn, still, 0.01)
    ahead, behind = (sensor_positions(level_bench.arm, q + by * dq) for by in (0.1, -0.1))
    velocity = (ahead - behind) / 0.2
    moving = np.clip(np.arange(12) - 3, 0, 6 if rests_again else 8)
    np.testing.assert_allclose(
        drawn.points, np.tile(0.01 * moving[:, None, None] * velocity, (3, 1, 1, 1)), atol=1e-6
    )
