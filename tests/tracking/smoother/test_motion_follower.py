"""Draws of a motion's errors scatter as the smoother says, and as the errors do."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.bench import Bench
from arm.kinematics import sensor_positions
from arm.model import Gyroscope
from tracking.model.draws import DRAWS, Draws
from tracking.model.expected_readings import room_of
from tracking.model.observation import observation_of
from tracking.smoother import motion_follower
from tracking.smoother.linear_response import respond
from tracking.smoother.motion_follower import MotionFollower, _creep, _with_lengths
from tracking.smoother.smoother import Smoother, release

RATE_HZ = 250.0


@pytest.fixture(scope="module")
def level_bench(dd_arm, recorded):
    """One short motion of the level arm."""
    return recorded(dd_arm, Bench(4000.0, trial_s=5.0, learning=1, evaluating=0), 0, 1.0)


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
    course, rng, draws = found.course, np.random.default_rng(1), 150
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
    beginning = slice(0, 500)  # paths of accelerometers drift away
    off = (followed.points - (true - true[0]))[beginning]
    scatter = np.sqrt(np.mean((draws.points[:, :, 0] - followed.points[:, 3])[:, beginning] ** 2))
    assert np.abs(off).max() < 0.05
    assert 0.2 < np.sqrt(np.mean(off[:, 3] ** 2)) / scatter < 3.0


def test_draws_of_each_joint_are_of_one_motion(followed):
    """Errors of a speed are the rate of those of the angle, and those of an acceleration the rate of its own."""
    draws, dt = followed.draws, followed.dt_s
    off = [getattr(draws, name) - getattr(followed, name) for name in ("q", "dq", "ddq")]
    for value, rate, alike in ((off[0], off[1], 0.99), (off[1], off[2], 0.9)):
        change = np.diff(value[:, 200:700], axis=1) / dt
        mean = 0.5 * (rate[:, 200:699] + rate[:, 201:700])
        for j in range(2):
            assert np.corrcoef(change[..., j].ravel(), mean[..., j].ravel())[0, 1] > alike
            assert change[..., j].std() == pytest.approx(mean[..., j].std(), rel=0.2)
    for values, of in zip(off, ("q", "dq", "ddq"), strict=True):
        assert np.abs(values.mean(axis=0)).max() < 0.6 * values.std(axis=0).max(), of


def test_drawn_paths_go_where_drawn_joints_do(level_bench, followed):
    """By other readings and other offsets, they are off together."""
    drawn = followed.draws
    for k in (1000, 1200):
        begin, end = (sensor_positions(level_bench.arm, drawn.q[:, at])[:, 3] for at in (0, k))
        gone, path = end - begin, drawn.points[:, k, 0]
        assert min(np.corrcoef(gone[:, c], path[:, c])[0, 1] for c in range(2)) > 0.75
        assert ((path - gone).std(axis=0) < 1.3e-3).all()


def test_the_same_seed_gives_the_same_draws(level_bench, readings, followed):
    again = MotionFollower(level_bench.arm, 0, (3,)).follow(readings, level_bench.q[0], None, level_bench.q[-1])
    np.testing.assert_array_equal(again.draws.points, followed.draws.points)


def test_a_motion_begins_with_what_the_one_before_it_left(level_bench, readings):
    follower = MotionFollower(level_bench.arm, 0, (3,))
    first = follower.follow(readings, level_bench.q[0], None, level_bench.q[0])
    end = first.draws.q[:, -1] - first.q[-1]
    at_rest = replace(readings, values=readings.values[:100])
    second = follower.follow(at_rest, level_bench.q[0], None, level_bench.q[0])
    begin = second.draws.q[:, 0] - second.q[0]
    # Not quite one and the same: what the second motion tells of its beginning is taken in.
    assert min(np.corrcoef(end[:, j], begin[:, j])[0, 1] for j in range(2)) > 0.7
    assert np.median(end.std(axis=0) / begin.std(axis=0)) == pytest.approx(1.0, abs=0.2)


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


BEGUN, SPREAD = np.arange(1.0, 11.0), np.diag(np.arange(1.0, 11.0)) + 0.5


def begun(follower, q, q_std=None):
    """Return how a motion begins whose smoother knows BEGUN with SPREAD: two joints, and four constants."""
    smoother = SimpleNamespace(begin=lambda _: (BEGUN.copy(), SPREAD.copy()))
    return follower._start(smoother, None, np.asarray(q), q_std)


def test_first_motion_begins_with_draws_of_all_that_is_unknown(dd_arm, monkeypatch):
    monkeypatch.setattr(motion_follower, "DRAWS", 40_000)
    follower = MotionFollower(dd_arm, 0, (3,))
    x, P = begun(follower, [0.0, 0.0])
    np.testing.assert_array_equal(x, BEGUN)
    np.testing.assert_array_equal(P, SPREAD)
    np.testing.assert_allclose(np.cov(follower._errors), SPREAD, atol=0.25)


def test_angles_are_known_no_better_than_the_tracker_says(dd_arm):
    P = begun(MotionFollower(dd_arm, 0, (3,)), [0.0, 0.0], np.array([0.5, 7.0]))[1]
    other = P - SPREAD
    assert P[0, 0] == SPREAD[0, 0] and P[3, 3] == 49.0
    other[3, 3] = 0.0
    np.testing.assert_array_equal(other, 0.0)


@pytest.mark.parametrize("moved", [(0.0199, -0.0199), (0.021, 0.0), (0.0, -0.021)])
def test_only_constants_last_where_the_arm_was_moved_unseen(dd_arm, moved):
    follower = MotionFollower(dd_arm, 0, (3,))
    left, sure, errors = -BEGUN, 2.0 * SPREAD, np.full((10, DRAWS), 3.0)
    follower._state, follower._errors, follower._told = (left, sure), errors, np.array([0.4, -0.6])
    x, P = begun(follower, follower._told + moved)
    if max(np.abs(moved)) < 0.02:
        assert x is left and P is sure and follower._errors is errors
        return
    np.testing.assert_array_equal(x, [*BEGUN[:6], *left[6:]])
    np.testing.assert_array_equal(P[6:, 6:], sure[6:, 6:])
    np.testing.assert_array_equal(P[:6], SPREAD[:6])
    np.testing.assert_array_equal(P[:, :6], SPREAD[:, :6])
    np.testing.assert_array_equal(follower._errors[6:], 3.0)
    assert (follower._errors[:6].std(axis=1) > 0.5).all()


def test_errors_of_readings_are_white_and_wander(dd_arm):
    n, dt = 300, 0.01
    noise, wander = np.tile([0.04, 0.09, 0.25], 4), np.repeat([0.0, 1.0, 4.0, 9.0], 3)
    rest = np.where(np.arange(n) < 100, 4.0, 0.0)[:, None] * [1.0, 9.0]
    course = SimpleNamespace(
        readings=np.zeros((n, 12)), noise=noise, wander=wander, dt=dt, push=np.ones(2), rest=rest
    )
    drawn = MotionFollower(dd_arm, 0, (3,))._noise(course)
    assert drawn.shape == (n, 14, DRAWS)
    steps = np.diff(drawn[:, :12], axis=0)
    np.testing.assert_allclose(steps.var(axis=(0, 2)), 2.0 * noise + wander * dt, rtol=0.06)
    np.testing.assert_allclose(drawn[0, :12].var(axis=1), noise + wander * dt, rtol=0.7)
    wandered = (drawn[-1, 3:12] - drawn[0, 3:12]).reshape(3, -1).var(axis=1)
    np.testing.assert_allclose(wandered, wander[3::3] * dt * (n - 1) + 2.0 * noise[:3].mean(), rtol=0.35)
    np.testing.assert_allclose(drawn[:100, 12:].std(axis=(0, 2)), [2.0, 6.0], rtol=0.06)
    np.testing.assert_array_equal(drawn[100:, 12:], 0.0)


def test_lengths_are_the_files_and_what_was_found_beside_it(spatial):
    of, size = observation_of(spatial)
    found = _with_lengths(spatial, of, 0.01 * np.arange(size))
    for i, (joint, before) in enumerate(zip(found.joints, spatial.joints, strict=True)):
        a, d = (0.01 * column if column >= 0 else 0.0 for column in of.length_column[i])
        assert joint.a_m == pytest.approx(before.a_m + a)
        assert joint.d_m == pytest.approx(before.d_m + d)
    assert found.joints[0].a_m > spatial.joints[0].a_m and found.joints[2].a_m == spatial.joints[2].a_m


def test_a_motion_without_gyroscopes_readings_is_of_accelerometers_alone(level_bench, readings, followed):
    arm = level_bench.arm
    turning = replace(arm.sensors[0], gyroscope=Gyroscope())
    follower = MotionFollower(replace(arm, sensors=(turning, *arm.sensors[1:])), 0, (3,))
    found = follower.follow(readings, level_bench.q[0], None, level_bench.q[-1])
    np.testing.assert_array_equal(found.q, followed.q)
    np.testing.assert_array_equal(found.draws.points, followed.draws.points)
