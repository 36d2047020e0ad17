"""Jumps of a sampled torque."""

import numpy as np
import pytest

from fitter.data.jumps import jumps, midway_at_jumps


@pytest.mark.parametrize("decay_s", [0.025, 0.003])
def test_a_jump_of_the_torque_is_put_midway_and_a_fast_change_is_not(decay_s):
    """A fast velocity loop takes most of a jump back by the next sample: it has jumped all the same."""
    t = 0.002 * np.arange(1000)
    after = t >= 0.5
    torque = np.where(after, 10.0 * np.exp(-(t - 0.5) / decay_s), 0.0)[:, None]
    torque += 0.01 * np.random.default_rng(1).normal(size=torque.shape)
    midway = midway_at_jumps(torque)
    at = int(np.argmax(after))
    assert midway[at, 0] == pytest.approx(5.0, abs=0.05)
    assert jumps(torque)[at, 0] == pytest.approx(10.0, abs=0.1)
    assert np.array_equal(np.delete(midway, at, axis=0), np.delete(torque, at, axis=0))


def test_noise_does_not_jump():
    torque = np.random.default_rng(0).normal(size=(5000, 2))
    assert np.array_equal(midway_at_jumps(torque), torque)


def zigzag(changes, n=2000, usual=0.01):
    """Return a torque that goes up and down by a little, and by these changes from row 1000 on; and that row."""
    steps = np.where(np.arange(n) % 2, usual, -usual)
    steps[1000 : 1000 + len(changes)] = changes
    return np.cumsum(steps)[:, None], 1000 + len(changes) - 1


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("changes", "jumped"),
    [
        ([0.201], False),  # twenty times the mean of all, which it raises by a hundredth itself
        ([0.203], True),
        ([2.6, 10.0], False),  # it was on its way already
        ([2.4, 10.0], True),
        ([2.6, 0.01, 10.0], False),
        ([2.4, 0.01, 10.0], True),
        ([2.6, 0.01, 0.01, 10.0], True),  # that was before
    ],
)
def test_a_jump_is_many_times_the_usual_change_and_sudden(changes, jumped, sign):
    torque, at = zigzag(sign * np.array(changes))
    assert jumps(torque)[at, 0] == (pytest.approx(sign * changes[-1]) if jumped else 0.0)
    np.testing.assert_allclose(midway_at_jumps(torque), torque - jumps(torque) / 2.0)


def test_the_mean_counts_where_most_changes_are_none():
    torque = np.zeros((100, 1))
    torque[50:] = 1.0
    assert jumps(torque)[50, 0] == 1.0  # a hundred times the mean
    few = torque[40:60]
    assert not jumps(few[:20]).any()  # twenty times
    assert jumps(torque[40:61])[10, 0] == 1.0


def test_joints_jump_by_themselves_and_the_first_sample_never():
    torque = np.ones((200, 2)) * [5.0, 3.0]
    torque[1:, 0] += 1.0
    torque[100:, 1] -= 2.0
    expected = np.zeros((200, 2))
    expected[1, 0], expected[100, 1] = 1.0, -2.0
    assert np.array_equal(jumps(torque), expected)
