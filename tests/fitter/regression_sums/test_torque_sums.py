"""Sums of the torque against all samples."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.regressor import regressor
from fitter.dynamics.torque_problem import torque_problem
from fitter.regression_sums.torque_sums import add_up, row_sums, torque_sums
from limbcal.errors import DataError

ARM = load_arm("dd-arm")
BASE = base_parameters(ARM)


def motion(n, seed):
    return np.random.default_rng(seed).normal(size=(4, n, 2))


def rows(q, dq, ddq):
    return regressor(ARM, q, dq, ddq)[..., BASE.independent]


def plain_cost(q, dq, ddq, tau, values):
    return np.sum((tau - rows(q, dq, ddq) @ values) ** 2)


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 400), st.integers(1, 400), st.integers(0, 99))
def test_sums_give_the_cost_of_all_samples(n, m, seed):
    first, second = motion(n, seed), motion(m, seed + 1)
    values = np.random.default_rng(seed).normal(size=(5, 8))
    added = torque_sums(ARM, BASE, *first) + torque_sums(ARM, BASE, *second)
    expected = [plain_cost(*first, x) + plain_cost(*second, x) for x in values]
    assert np.allclose(added.cost(values), expected, rtol=1e-10)
    assert np.allclose(added.total().cost(values), expected, rtol=1e-10)
    assert added.samples == n + m
    assert set(added.trial) == {0, 1}


def test_added_sums_are_the_sums_of_all():
    q, dq, ddq, tau = motion(1000, 0)
    whole = torque_sums(ARM, BASE, q, dq, ddq, tau).total()
    parts = [torque_sums(ARM, BASE, q[s], dq[s], ddq[s], tau[s]) for s in (slice(0, 300), slice(300, None))]
    for name in ("gram", "moment", "power", "row", "torque", "count"):
        assert np.allclose(getattr(add_up(parts).total(), name), getattr(whole, name), rtol=1e-12, atol=1e-9)


def test_residuals_and_scores():
    q, dq, ddq, tau = motion(777, 1)
    values = np.arange(8.0)
    sums, W = torque_sums(ARM, BASE, q, dq, ddq, tau), rows(q, dq, ddq)
    residual = tau - W @ values
    assert np.allclose(sums.rms(values), np.sqrt(np.mean(residual**2, axis=0)))
    assert np.allclose(sums.scores(values).sum(axis=0), np.einsum("kja,kj->a", W, residual))


def test_resting_joints_are_left_out():
    q, dq, ddq, tau = motion(200, 2)
    dq[50:90, 0] = 0.0
    sums = torque_sums(ARM, BASE, q, dq, ddq, tau)
    assert sums.count.sum(axis=0).tolist() == [160, 200]
    fast = np.abs(dq) > 0.5
    assert torque_sums(ARM, BASE, q, dq, ddq, tau, 0.5).count.sum(axis=0).tolist() == fast.sum(axis=0).tolist()
    residual = (tau - rows(q, dq, ddq) @ np.ones(8)) * (dq != 0.0)
    assert np.isclose(sums.cost(np.ones((1, 8)))[0], np.sum(residual**2))


def test_rows_that_are_there_give_the_same_sums():
    q, dq, ddq, tau = motion(500, 3)
    dq[:20, 1] = 0.0
    fused, plain = torque_sums(ARM, BASE, q, dq, ddq, tau), row_sums(rows(q, dq, ddq), tau, dq != 0.0)
    for name in ("gram", "moment", "power", "row", "torque", "count"):
        assert np.allclose(getattr(fused, name), getattr(plain, name), atol=1e-10)


def test_centring_fits_a_constant_of_its_own_to_each_trial_and_joint():
    trials = [motion(300, seed) for seed in (4, 5)]
    values = np.linspace(-1.0, 1.0, 8)
    constants = np.array([[1.0, -2.0], [0.3, 4.0]])
    parts = []
    for (q, dq, ddq, _), constant in zip(trials, constants, strict=True):
        parts.append(torque_sums(ARM, BASE, q, dq, ddq, rows(q, dq, ddq) @ values + constant))
    sums = add_up(parts)
    assert sums.centred().cost(values[None])[0] < 1e-9
    assert np.allclose(sums.constants(values), constants, atol=1e-9)
    assert np.allclose(add_up([part.centred() for part in parts]).gram, sums.centred().gram)
    noise = np.random.default_rng(0).normal(size=(300, 2))
    q, dq, ddq, _ = trials[0]
    W = rows(q, dq, ddq)
    centred = torque_sums(ARM, BASE, q, dq, ddq, noise).centred()
    residual = noise - W @ values
    assert np.isclose(centred.cost(values[None])[0], np.sum((residual - residual.mean(axis=0)) ** 2))


def test_says_which_arrays_dont_fit():
    q, dq, ddq, tau = motion(10, 0)
    with pytest.raises(DataError, match=r"9, 10"):
        torque_sums(ARM, BASE, q, dq, ddq, tau[:9])


def test_a_velocity_that_never_turns_tells_no_coulomb_friction_beside_an_unknown_constant():
    """The filter of the trial leaves a little of the sign's column, which must not pass for information."""
    rng = np.random.default_rng(5)
    rows = rng.normal(size=(400, 1, 2))
    rows[:, 0, 1] = 1.0 + 1e-4 * rng.normal(size=400)
    moving = np.ones((400, 1), dtype=bool)
    problem = torque_problem(row_sums(rows, rows @ [2.0, 0.5], moving).centred(), np.zeros(2))
    assert problem.revealed.tolist() == [True, False]
    assert np.allclose(problem.complete(problem.optimum()), [2.0, 0.0], atol=1e-4)
