"""Torque columns with the wrong sign or in each other's place are named by what masses can be."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Arm, Control
from arm.newton_euler import inverse_dynamics
from arm.structural_parameters import structural_parameters
from fitter.data.trial import Trial
from fitter.dynamics.torque_wiring import check_wiring
from tests.arm.conftest import draw_arm

ARM = replace(load_arm("dd-arm-vertical"), control=Control())
BASE = structural_parameters(ARM)


def driven(arm: Arm, seed: int) -> Trial:
    """Return a motion of three sines a joint with the torque that it takes, and 2 % of noise."""
    rng, n, dt_s = np.random.default_rng(seed), arm.n_joint, 4e-3
    t = dt_s * np.arange(750)
    size, pulse, phase = (rng.uniform(*span, (3, 1, n)) for span in ((0.2, 0.8), (1.0, 8.0), (0.0, 6.0)))
    angle = pulse * t[:, None] + phase
    q, dq = (size * np.sin(angle)).sum(0), (size * pulse * np.cos(angle)).sum(0)
    ddq = (-size * pulse**2 * np.sin(angle)).sum(0)
    tau = inverse_dynamics(arm, q, dq, ddq)
    tau = tau + 0.02 * np.std(tau, axis=0) * rng.normal(size=tau.shape)
    return Trial("driven", t, dt_s, q, dq, ddq, tau=tau)


def wired(trial: Trial, column: tuple[int, ...], sign: tuple[int, ...]) -> Trial:
    return replace(trial, tau=trial.tau[:, column] * np.array(sign))


@pytest.mark.parametrize("seed", range(3))
def test_columns_as_they_are_raise_no_question(seed):
    check = check_wiring(ARM, BASE, [driven(ARM, seed)])
    assert check.better is None and check.possible < 2.0 * check.free < 0.01


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("column", "sign", "words"),
    [
        ((0, 1), (-1, -1), "the sign of tau1 and tau2 turned they are possible: are tau1 and tau2 the load's?"),
        ((0, 1), (-1, 1), "with the sign of tau1 turned they are possible: is tau1 the load's?"),
        ((0, 1), (1, -1), "with the sign of tau2 turned they are possible: is tau2 the load's?"),
        ((1, 0), (1, 1), "are tau1 and tau2 exchanged?"),
    ],
)
def test_each_way_of_being_wrong_is_named(seed, column, sign, words):
    check = check_wiring(ARM, BASE, [wired(driven(ARM, seed), column, sign)])
    assert words in check.better.sentence


def test_three_joints_too():
    arm = replace(draw_arm(np.random.default_rng(5), 3, prismatic=False), control=Control())
    trial, base = driven(arm, 5), structural_parameters(arm)
    assert check_wiring(arm, base, [trial]).better is None
    check = check_wiring(arm, base, [wired(trial, (0, 2, 1), (1, 1, 1))])
    assert check.better.column == (0, 2, 1) and check.better.sign == (1, 1, 1)


def test_under_a_law_nothing_is_exchanged():
    law = load_arm("dd-arm-vertical")
    trial = driven(ARM, 0)
    assert check_wiring(law, BASE, [replace(trial, ref=trial.q)]).better is None


def test_no_torque_tells_nothing():
    trial = driven(ARM, 0)
    assert check_wiring(ARM, BASE, [replace(trial, tau=np.zeros_like(trial.q))]) is None


@pytest.mark.parametrize(("n", "seed"), [(2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (6, 0)])
def test_gravity_that_falls_up_in_the_arm_file_is_named(n, seed):
    arm = ARM if n == 2 else replace(draw_arm(np.random.default_rng(seed), n, prismatic=False), control=Control())
    x, y, z = arm.gravity_m_s2
    wrong = replace(arm, gravity_m_s2=(-x, -y, -z))
    trial, base = driven(arm, seed), structural_parameters(arm)
    assert check_wiring(arm, base, [trial]).better is None
    check = check_wiring(wrong, structural_parameters(wrong), [trial])
    assert check.better.falls_up and "sign of gravity_m_s2" in check.better.sentence


def test_a_law_s_torque_tells_gravity_s_sign_too():
    law = replace(load_arm("dd-arm-vertical"), gravity_m_s2=(0.0, 9.80665, 0.0))
    kp, kv = np.array(law.control.kp), np.array(law.control.kv)
    trial = driven(ARM, 0)
    ref = trial.q + (trial.tau - kv * trial.dq) / kp
    assert law.control.law == "pd" and check_wiring(law, BASE, [replace(trial, ref=ref)]).better.falls_up


def test_gravity_along_all_axes_has_no_sign():
    flat = replace(load_arm("dd-arm"), control=Control())
    upside_down = replace(flat, gravity_m_s2=(0.0, 0.0, 9.80665))
    assert check_wiring(upside_down, structural_parameters(upside_down), [driven(flat, 0)]).better is None
