"""Equations over bands of frequency."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from arm.newton_euler import inverse_dynamics
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.data.derived_trial import derive
from fitter.data.motions import Measured
from fitter.data.resample import Uniform
from fitter.data.trial import Trial
from fitter.dynamics.torque_problem import torque_problem
from fitter.regression_sums.spectral_sums import spectral_sums
from limbcal.errors import DataError

ARM = replace(load_arm("spatial-arm"), control=Control())
BASE = structural_parameters(ARM)
TRUE = BASE.combination @ standard_parameters(ARM)


def wave(seed, hz=250.0, seconds=12.0, fastest=1.2):
    """Return a smooth motion of all joints and the torque that it takes."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * hz)) / hz
    q, dq, ddq = np.zeros((3, len(t), ARM.n_joint))
    for w in 2.0 * np.pi * rng.uniform(0.2, fastest, 5):
        size, phase = rng.normal(size=ARM.n_joint) * 0.5, rng.uniform(0.0, 6.0, ARM.n_joint)
        angle = w * t[:, None] + phase
        q, dq, ddq = q + size * np.sin(angle), dq + size * w * np.cos(angle), ddq - size * w**2 * np.sin(angle)
    return Trial("wave", t, 1.0 / hz, q, dq, ddq, tau=inverse_dynamics(ARM, q, dq, ddq))


def answer(trials):
    problem = torque_problem(spectral_sums(ARM, BASE, trials).sums, np.zeros(len(TRUE)))
    return problem.complete(problem.optimum())


@pytest.mark.parametrize("seed", range(3))
def test_without_noise_they_give_the_truth(seed):
    trials = [wave(seed), wave(seed + 10, hz=100.0, seconds=5.0)]
    assert np.allclose(answer(trials), TRUE, rtol=1e-6, atol=1e-8)


def test_what_holds_a_joint_that_rests_shifts_nothing():
    trial = wave(0)
    still = np.arange(len(trial.t)) > 0.6 * len(trial.t)
    q, dq, ddq = trial.q.copy(), trial.dq.copy(), trial.ddq.copy()
    q[still, 0], dq[still, 0], ddq[still, 0] = q[~still][-1, 0], 0.0, 0.0
    tau = inverse_dynamics(ARM, q, dq, ddq)
    tau[still, 0] += 5.0 * np.sin(np.arange(still.sum()))  # friction takes up anything
    assert np.allclose(answer([replace(trial, q=q, dq=dq, ddq=ddq, tau=tau)]), TRUE, rtol=1e-6, atol=1e-8)


def test_a_joint_that_turns_round_between_two_samples_is_taken_to_rest():
    """At 40 rad/s^2 and 100 Hz no sample is slower than the speed of a rest."""
    trial = wave(3, hz=100.0, fastest=4.0)
    dq = trial.dq
    turned = np.abs(np.diff(np.sign(dq), axis=0)).any(axis=1)
    assert np.any(turned & (np.abs(dq) > 0.02)[1:].all(axis=1) & (np.abs(dq) > 0.02)[:-1].all(axis=1))
    # A measured sign comes a sample late there; nothing may hang on it.
    late = dq.copy()
    for j in range(ARM.n_joint):
        k = np.flatnonzero(np.diff(np.sign(dq[:, j])))
        late[k + 1, j] = 0.03 * np.sign(dq[k, j])
    tau = inverse_dynamics(ARM, trial.q, dq, trial.ddq)
    friction = np.array([joint.friction.coulomb_N_m for joint in ARM.joints])
    tau += friction * (np.sign(late) - np.sign(dq))
    assert np.allclose(answer([replace(trial, tau=tau)]), TRUE, rtol=1e-6, atol=1e-8)


def test_a_band_has_the_noise_of_its_frequencies():
    rng = np.random.default_rng(0)
    trial = wave(1, seconds=60.0)
    noise = 0.3 * rng.normal(size=trial.tau.shape)
    sums = spectral_sums(ARM, BASE, [replace(trial, tau=trial.tau + noise)]).sums
    left = sums.power - np.einsum("bja,a->bj", 2.0 * sums.moment - sums.gram @ TRUE, TRUE)
    of_one = left.sum(axis=0) / sums.count.sum(axis=0)  # a coefficient's variance is a sample's
    assert np.allclose(of_one, 0.09, rtol=0.1)


def test_a_torque_that_was_cut_off_shifts_nothing():
    trial = wave(4)
    limit = 0.7 * np.abs(trial.tau).max(axis=0)
    cut = np.clip(trial.tau, -limit, limit)
    marked = np.abs(trial.tau) >= limit
    assert marked.any() and not np.allclose(answer([replace(trial, tau=cut)]), TRUE, rtol=1e-3)
    assert np.allclose(answer([replace(trial, tau=cut, contradicted=marked)]), TRUE, rtol=1e-6, atol=1e-8)
    derived = derive(Uniform(Measured("m", "m", 0, trial.t, {"q": trial.q, "tau": cut}), trial.dt_s), 8.0, 4.0)
    inner = slice(derived.trimmed, len(marked) - derived.trimmed)
    found = answer([replace(derived, contradicted=marked[inner])])
    assert np.allclose(found, TRUE, rtol=2e-3, atol=2e-3)


def test_long_trials_are_cut_and_still_hold(monkeypatch):
    monkeypatch.setattr("fitter.regression_sums.spectral_sums._ROW_BYTES", 200_000)
    assert np.allclose(answer([wave(2)]), TRUE, rtol=1e-6, atol=1e-8)


def test_it_says_that_there_is_no_torque():
    with pytest.raises(DataError, match="no torque"):
        spectral_sums(ARM, BASE, [replace(wave(0), tau=None)])
