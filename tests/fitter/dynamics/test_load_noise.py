"""The scatter of a load's means, from what the torque equation leaves of a moving joint."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from arm.newton_euler import inverse_dynamics
from fitter.data.trial import Trial
from fitter.dynamics.load_noise import load_noise


@pytest.mark.parametrize("together", [1, 25])
def test_noise_that_hangs_together_is_not_averaged_away(together):
    arm = replace(load_arm("dd-arm"), control=Control())
    rng, dt, n = np.random.default_rng(0), 0.002, 50_000
    t = np.arange(n) * dt
    q = np.column_stack([t, 2.0 * t])
    dq, ddq = np.tile([1.0, 2.0], (n, 1)), np.zeros((n, 2))
    noise = np.repeat(0.1 * rng.normal(size=(n // together, 2)), together, axis=0)
    tau = inverse_dynamics(arm, q, dq, ddq) + noise
    found = load_noise(arm, [Trial("turns", t, dt, q, dq, ddq, tau, None)], 1)
    assert found.of_means(1) == pytest.approx(0.1, rel=0.1)
    assert found.of_means(400) == pytest.approx(0.1 * np.sqrt(together / 400), rel=0.3)
