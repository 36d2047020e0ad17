"""The least possible error, against an arm whose motion has a closed form."""

from dataclasses import replace

import numpy as np

from arm.base_parameters import base_parameters
from arm.model import Arm, Control, Friction, Joint, Link
from arm.simulation import simulate
from fitter.data.trial import Trial
from reproduction.bench_data import bench_trials, true_arm
from reproduction.cramer_rao import least_std

INERTIA, VISCOUS, COULOMB, KP, KV = 0.8, 0.3, 0.2, 4.0, -5.0
SIGMA, TARGET = 0.01, 1.0


def closed_form(t, inertia, viscous, coulomb, q0, v0):
    """Return the angle of an overdamped joint that only ever moves forwards: friction is a constant push."""
    end = TARGET - coulomb / KP
    fast, slow = np.roots([inertia, viscous - KV, KP])
    a = (v0 - slow * (q0 - end)) / (fast - slow)
    b = (q0 - end) - a
    return end + a * np.exp(fast * t) + b * np.exp(slow * t)


def test_it_is_the_inverse_of_the_information_with_the_start_unknown():
    link = Link(mass_kg=1.0, inertia_kg_m2=(0.5, 0.5, INERTIA, 0.0, 0.0, 0.0))
    joint = Joint(a_m=0.3, friction=Friction(VISCOUS, COULOMB, 0.0), link=link)
    arm = Arm("one joint", (joint,), gravity_m_s2=(0.0, 0.0, 0.0), control=Control("pd", (KP,), (KV,)))
    assert base_parameters(arm).names == ("I1", "D1", "fc1")
    ref = np.full((1000, 1), TARGET)
    motion = simulate(arm, ref, 2e-3, np.zeros(1), np.array([0.1]))
    true = np.array([INERTIA, VISCOUS, COULOMB, 0.0, 0.1])
    np.testing.assert_allclose(motion.q[:, 0], closed_form(motion.t, *true), atol=1e-8)
    trial = Trial("x", motion.t, 2e-3, motion.q, motion.dq, motion.ddq, ref=ref)
    J = np.column_stack(
        [
            (closed_form(motion.t, *(true + step)) - closed_form(motion.t, *(true - step))) / 2e-5
            for step in 1e-5 * np.eye(5)
        ]
    )
    expected = SIGMA * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))[:3]
    np.testing.assert_allclose(least_std(arm, [trial], np.array([SIGMA]), 1000), expected, rtol=1e-3)


def test_it_follows_noise_and_number_of_samples():
    arm = true_arm()
    trials = [replace(trial, tau=None) for trial in bench_trials(arm, 1200, learning=2)]
    noise = np.array([0.01, 0.02])
    least = least_std(arm, trials, noise, 1200)
    np.testing.assert_allclose(least_std(arm, trials, 3.0 * noise, 4 * 1200), 1.5 * least, rtol=1e-9)
