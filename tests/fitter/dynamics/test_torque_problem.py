"""What the data tells of the base parameters."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.regressor import regressor
from fitter.dynamics.torque_problem import torque_problem
from fitter.regression_sums.torque_sums import torque_sums
from limbcal.errors import NotIdentifiable

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)
TRUE = np.array([2.0, 1.7, 0.2, 0.5, 0.1, 0.05, 0.02, 0.01])


def sums_of(noise, seed=0, still=False, n=3000):
    rng = np.random.default_rng(seed)
    q, dq, ddq = rng.normal(size=(3, n, 2))
    if still:
        q[:, 1] = dq[:, 1] = ddq[:, 1] = 0.0
    tau = regressor(ARM, q, dq, ddq)[..., BASE.independent] @ TRUE + noise * rng.normal(size=(n, 2))
    return torque_sums(ARM, BASE, q, dq, ddq, tau)


def test_the_optimum_is_that_of_least_squares():
    problem = torque_problem(sums_of(0.0), np.zeros(8))
    assert np.allclose(problem.complete(problem.optimum()), TRUE, rtol=1e-9)
    assert np.all(problem.revealed)
    noisy = torque_problem(sums_of(0.3), np.zeros(8))
    best = noisy.cost(noisy.optimum()[None])[0]
    nearby = noisy.optimum() + 1e-3 * np.random.default_rng(0).normal(size=(50, 8))
    assert np.all(noisy.cost(nearby) > best)
    assert np.allclose(noisy.cost(nearby), noisy.sums.cost(nearby), rtol=1e-9)


def test_default_bounds_hold_whatever_explains_the_torque_at_all():
    for seed in range(20):
        problem = torque_problem(sums_of(5.0, seed, n=30), np.zeros(8))
        lower, upper = problem.bounds()
        assert np.all((lower < 0.0) & (problem.optimum() > lower) & (problem.optimum() < upper))
        rng = np.random.default_rng(seed)
        outside = rng.choice([-1.0, 1.0], (100, 8)) * upper * rng.uniform(1.0, 3.0, (100, 8))
        assert np.all(problem.cost(outside) > problem.sums.power.sum())


def test_standard_errors_are_those_of_the_noise():
    answers, errors = [], []
    for seed in range(60):
        problem = torque_problem(sums_of(0.3, seed, n=500), np.zeros(8))
        answers.append(problem.optimum())
        errors.append(problem.standard_errors(problem.complete(answers[-1])))
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / np.std(answers, axis=0)
    assert np.all((ratio > 0.7) & (ratio < 1.4))


def test_a_joint_that_never_moves_leaves_its_parameters_at_the_prior():
    prior = np.arange(8.0) / 100
    problem = torque_problem(sums_of(0.0, still=True), prior)
    values = problem.complete(problem.optimum())
    names = np.array(BASE.names)
    identifiable = set(names[problem.revealed])
    assert identifiable == {"D1", "fc1"}  # the links turn as one: their inertias come only as a sum
    for name in ("D2", "fc2"):
        k = BASE.names.index(name)
        assert values[k] == prior[k]
        assert np.isnan(problem.standard_errors(values)[k])
    assert problem.cost(problem.optimum()[None])[0] < 1e-9  # the sum is right all the same


def test_held_parameters_are_not_sought():
    problem = torque_problem(sums_of(0.0), np.zeros(8), {0: 2.0, 6: 0.02})
    assert problem.free.tolist() == [1, 2, 3, 4, 5, 7]
    assert np.allclose(problem.complete(problem.optimum()), TRUE, rtol=1e-9)
    wrong = torque_problem(sums_of(0.0), np.zeros(8), {0: 1.9})
    assert wrong.complete(wrong.optimum())[0] == 1.9
    assert np.isclose(
        wrong.cost(wrong.optimum()[None])[0], wrong.sums.cost(wrong.complete(wrong.optimum())[None])[0]
    )


def test_says_when_there_is_nothing_to_tell():
    sums = sums_of(0.0)
    with pytest.raises(NotIdentifiable, match="torque is zero"):
        torque_problem(replace(sums, power=0.0 * sums.power, moment=0.0 * sums.moment), np.zeros(8))
    with pytest.raises(NotIdentifiable, match="none is sought"):
        torque_problem(sums, np.zeros(8), dict.fromkeys(range(8), 0.0))
