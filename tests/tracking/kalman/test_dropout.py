"""What is held of a motion that nobody saw, against the random motion that it is held to be."""

import numpy as np
import pytest

from tracking.kalman.dropout import LOST_STD, PREDICTABLE_S, TOLD_S, Loss, most_probable_way
from tracking.model.process_noise import SMOOTHER_PUSH_STD

DT_S = 0.004


def state(rng):
    """Return the state of two joints and what else is known, and a covariance."""
    root = rng.normal(size=(8, 8))
    return rng.normal(size=8), root @ root.T


def missed(loss, x, P, seconds):
    return [loss.miss(x, P) for _ in range(round(seconds / DT_S))]


def test_a_motion_is_lost_when_it_can_be_predicted_no_more():
    loss, (x, P) = Loss(2, DT_S), state(np.random.default_rng(0))
    told = missed(loss, x, P, 0.4)
    assert told == [(k + 1) * DT_S > PREDICTABLE_S for k in range(100)]
    assert loss.lost and loss.seconds == pytest.approx(0.4)
    loss.find()
    assert not loss.lost


def test_who_lost_the_arm_forgets_its_motion_and_nothing_else():
    loss, (x, P) = Loss(2, DT_S), state(np.random.default_rng(1))
    before_x, before_P = x.copy(), P.copy()
    loss.forget(x, P)
    np.testing.assert_array_equal(x[[0, 3, 6, 7]], before_x[[0, 3, 6, 7]])
    np.testing.assert_array_equal(x[[1, 2, 4, 5]], 0.0)
    np.testing.assert_array_equal(P[6:, 6:], before_P[6:, 6:])
    np.testing.assert_array_equal(P[:6, 6:], 0.0)
    np.testing.assert_array_equal(P[:6, :6], np.diag(np.square([*LOST_STD, *LOST_STD])))


def pushed(T):
    """Return transition and covariance of angle, speed and acceleration pushed at random for a time T."""
    steps = 20_000
    s = (np.arange(steps) + 0.5) * T / steps
    effect = np.stack([0.5 * (T - s) ** 2, T - s, np.ones(steps)])
    F = np.array([[1.0, T, T**2 / 2], [0.0, 1.0, T], [0.0, 0.0, 1.0]])
    return F, SMOOTHER_PUSH_STD**2 * effect @ effect.T * T / steps


@pytest.mark.parametrize("seconds", [0.26, 0.4])
def test_what_both_ends_show_tells_how_far_the_joints_have_come(seconds):
    """By the joint distribution of the motion's end, given where it began; short enough for its own variance."""
    loss, (x, P) = Loss(2, DT_S), state(np.random.default_rng(2))
    before = x[:6].reshape(2, 3).copy()
    missed(loss, x, P, seconds)
    later_s = 0.016
    loss.regain(later_s, x, P)
    F, Q = pushed(seconds + later_s)
    gain = Q[0, 1:] @ np.linalg.inv(Q[1:, 1:])
    left = Q[0, 0] - gain @ Q[1:, 0]
    seen = np.array([[0.3, -2.0], [1.1, 4.0]])
    for j in range(2):
        block, end = P[3 * j : 3 * j + 3, 3 * j : 3 * j + 3], F @ before[j]
        by_ends = end[0] + gain @ (seen[j] - end[1:])
        ours = block[0, 1:] @ np.linalg.inv(block[1:, 1:])
        assert x[3 * j] + ours @ (seen[j] - x[3 * j + 1 : 3 * j + 3]) == pytest.approx(by_ends, abs=1e-6)
        assert block[0, 0] - ours @ block[1:, 0] == pytest.approx(min(left, 0.5), rel=1e-3)
    assert np.linalg.eigvalsh(P[:6, :6]).min() > 0.0
    np.testing.assert_array_equal(P[:6, 6:], 0.0)


def test_frames_that_nobody_gives_out_count():
    loss, (x, P) = Loss(2, DT_S), state(np.random.default_rng(3))
    missed(loss, x, P, 1.0)
    loss.skip(250)
    assert loss.seconds == pytest.approx(2.0)


def test_long_after_a_motion_its_joints_are_still_about_where_they_were():
    loss, (x, P) = Loss(2, DT_S), state(np.random.default_rng(4))
    missed(loss, x, P, 1.0)
    loss.skip(round(TOLD_S / DT_S))
    before_x, before_P = x.copy(), P.copy()
    loss.regain(0.0, x, P)
    np.testing.assert_array_equal(x, before_x)
    np.testing.assert_array_equal(P, before_P)


def test_while_a_motion_is_lost_only_where_the_arm_is_grows_doubtful():
    loss, (x, P) = Loss(2, DT_S), state(np.random.default_rng(5))
    lost_s = DT_S * sum(missed(loss, x, P, 1.0))
    assert lost_s == pytest.approx(1.0 - PREDICTABLE_S, abs=DT_S)
    angle, speed, acceleration = np.square(LOST_STD)
    joint = [angle * (1.0 + lost_s), speed, acceleration]
    np.testing.assert_allclose(P[:6, :6], np.diag([*joint, *joint]), rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    ("T", "v0", "a0", "v1", "a1", "way"),
    [(2.0, 1.0, 0.0, 3.0, 0.0, 4.0), (2.0, 0.0, 3.0, 0.0, 0.0, 1.0), (2.0, 0.0, 0.0, 0.0, 6.0, -2.0)],
)
def test_a_way_goes_by_speeds_and_accelerations_at_both_ends(T, v0, a0, v1, a1, way):
    assert most_probable_way(T, *(np.array([x]) for x in (v0, a0, v1, a1))) == pytest.approx([way])


def test_a_quarter_of_a_second_is_predicted_and_one_and_a_half_tell():
    loss, (x, P) = Loss(2, 0.125), state(np.random.default_rng(6))
    assert [loss.miss(x, P) for _ in range(3)] == [False, False, True]
    for frames, regained in ((12, True), (13, False)):  # 1.5 s and more
        loss, (x, P) = Loss(2, 0.125), state(np.random.default_rng(7))
        for _ in range(3):
            loss.miss(x, P)
        loss.skip(frames - 3)
        before = x.copy()
        loss.regain(0.0, x, P)
        assert np.array_equal(x, before) != regained


def test_what_is_left_of_a_lost_motion_is_half_a_radian():
    loss, (x, P) = Loss(1, 1.0), (np.ones(3), np.eye(3))
    assert loss.miss(x, P)
    np.testing.assert_allclose(np.diag(P), [0.25 + 0.25, 9.0, 100.0])  # as much again in a second
    np.testing.assert_array_equal(x, [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(loss.before, np.ones((1, 3)))
    loss.retime(2.0)
    assert loss.seconds == 2.0
    loss.miss(x, P)
    assert P[0, 0] == pytest.approx(0.25 + 0.25 + 0.5)
