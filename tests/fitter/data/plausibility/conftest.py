"""Motions that are free of faults, for a fault to be put into."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from arm.model import Arm, Control
from arm.newton_euler import inverse_dynamics
from fitter.data.motions import Measured

Make = Callable[..., Measured]


@pytest.fixture(scope="session")
def arm() -> Arm:
    """Return an arm of two joints with gravity, whose torque is measured."""
    return replace(load_arm("dd-arm-vertical"), control=Control())


@pytest.fixture(scope="session")
def clean(arm: Arm) -> Make:
    """Return what makes a motion of three sines a joint, with torque and tip, by a seed and the motion's size."""

    def make(seed: int = 0, size: float = 1.0, rate_hz: float = 250.0) -> Measured:
        rng, n = np.random.default_rng(seed), arm.n_joint
        t = np.arange(0.0, 4.0, 1.0 / rate_hz)
        amplitude, pulse, phase = (rng.uniform(*span, (3, 1, n)) for span in ((0.2, 0.6), (1.0, 7.0), (0.0, 6.28)))
        angle = pulse * t[:, None] + phase
        q = size * (amplitude * np.sin(angle)).sum(0)
        dq = size * (amplitude * pulse * np.cos(angle)).sum(0)
        ddq = -size * (amplitude * pulse**2 * np.sin(angle)).sum(0)
        tau = inverse_dynamics(arm, q, dq, ddq)
        tau = tau + 0.01 * np.std(tau, axis=0) * rng.normal(size=tau.shape)
        columns = {"q": q + 1e-5 * rng.normal(size=q.shape), "tau": tau, "tip": tip_position(arm, q)}
        return Measured("clean", "clean.csv", 0, t, columns)

    return make


def changed(motion: Measured, **columns: np.ndarray) -> Measured:
    """Return a motion some of whose columns are others."""
    return replace(motion, columns={**motion.columns, **columns})
