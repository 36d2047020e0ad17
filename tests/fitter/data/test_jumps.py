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
