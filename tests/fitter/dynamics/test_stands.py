"""What the stands of one joint prove."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control, Friction
from arm.newton_euler import inverse_dynamics
from arm.structural_parameters import structural_parameters
from fitter.data.trial import Trial
from fitter.dynamics.load_noise import LoadNoise
from fitter.dynamics.stands import has_torque, stands

ARM = replace(load_arm("dd-arm"), control=Control())
ARM = replace(ARM, joints=tuple(replace(joint, friction=Friction()) for joint in ARM.joints))
DT_S, STILL, N = 0.002, 500, 1000
NOISELESS = LoadNoise(np.array([1]), np.array([0.0]))


def pulled(slope):
    """Return a trial whose second joint stands under a rising torque and then moves off, the first at rest."""
    t = DT_S * np.arange(N)
    ddq = np.zeros((N, 2))
    ddq[STILL:, 1] = 1.0
    dq = DT_S * np.cumsum(ddq, axis=0)
    q = DT_S * np.cumsum(dq, axis=0)
    tau = inverse_dynamics(ARM, q, dq, ddq)
    tau[:STILL, 1] = slope * t[:STILL]
    return Trial("pulled", t, DT_S, q, dq, ddq, tau)


@pytest.mark.parametrize("slope", [0.5, -2.0])
def test_friction_held_the_last_torque_and_let_go_of_hardly_more(slope):
    (stand,) = stands(ARM, structural_parameters(ARM), pulled(slope), 1, NOISELESS)
    last = abs(slope) * DT_S * STILL
    assert 0.9 * last < stand.held.value <= last
    if slope > 0.0:
        assert stand.let_go.value >= 0.99 * last


def test_a_joint_that_always_moves_has_none():
    trial = pulled(1.0)
    assert not stands(ARM, structural_parameters(ARM), replace(trial, dq=trial.dq + 1.0), 1, NOISELESS)


def test_measured_torque_or_a_target_is_needed():
    trial = pulled(1.0)
    assert has_torque(ARM, trial)
    assert not has_torque(ARM, replace(trial, tau=None))
    assert not has_torque(replace(ARM, control=Control("p", (1.0, 1.0))), trial)
