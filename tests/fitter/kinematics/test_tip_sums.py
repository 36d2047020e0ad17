"""Sums of the tip against all samples."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.kinematics import tip_position
from fitter.kinematics.tip_basis import basis, coefficients, geometry_of, turning
from fitter.kinematics.tip_sums import TipSums, add_up, no_sums, tip_sums
from limbcal.errors import DataError

ARM = load_arm("dd-arm")


def motion(n, seed):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, 2)), rng.normal(size=(n, 3)), rng.normal(size=2)


def cost(sums, C):
    w = sums.whitened()
    return np.sum((w.W @ C.T - w.z) ** 2) + w.rest.sum()


def plain_cost(q, moved, rest, C):
    phi = basis(turning(ARM), q) - basis(turning(ARM), rest[None])
    return np.sum((moved - phi[:, 1:] @ C.T) ** 2)


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 300), st.integers(1, 300), st.integers(0, 99))
def test_sums_give_the_cost_of_all_samples(n, m, seed):
    first, second = motion(n, seed), motion(m, seed + 1)
    C = np.random.default_rng(seed).normal(size=(3, 8))
    sums = tip_sums(ARM, *first) + tip_sums(ARM, *second, trial=1)
    expected = plain_cost(*first, C) + plain_cost(*second, C)
    assert np.isclose(cost(sums, C), expected, rtol=1e-9)
    assert np.isclose(cost(sums.total() + no_sums(ARM), C), expected, rtol=1e-9)
    assert sums.samples == sums.total().samples == n + m


def test_stretches_of_a_trial_add_up_to_it():
    q, moved, rest = motion(1000, 0)
    whole = tip_sums(ARM, q, moved, rest).total()
    parts = [tip_sums(ARM, q[s], moved[s], rest) for s in (slice(0, 10), slice(10, 400), slice(400, None))]
    for name in ("gram", "moment", "power", "count"):
        assert np.allclose(getattr(add_up(parts).total(), name), getattr(whole, name), rtol=1e-12, atol=1e-10)


def test_the_true_geometry_costs_nothing_wherever_the_base_stands():
    q = motion(200, 0)[0]
    tip = tip_position(ARM, q) + [3.0, -1.0, 7.0]
    C = coefficients(turning(ARM), geometry_of(ARM)[None])[0, :, 1:]
    assert cost(tip_sums(ARM, q, tip - tip[0], q[0]), C) < 1e-12
    assert cost(tip_sums(ARM, q, tip - tip[:20].mean(axis=0), q[:20]), C) < 1e-12
    assert cost(tip_sums(ARM, q, tip), C) < 1e-12  # about the means


def test_thinning_keeps_sums_and_trials():
    rng = np.random.default_rng(0)
    n = 5001
    trial = np.repeat([4, 6], [2001, 3000])
    sums = TipSums(rng.normal(size=(n, 8, 8)), rng.normal(size=(n, 8, 3)), np.ones((n, 3)), np.ones(n), trial)
    thin = sums.thinned()
    assert len(thin.trial) == 2501
    assert thin.trial.tolist() == [4] * 1001 + [6] * 1500
    assert np.allclose(thin.total().gram, sums.total().gram)
    assert thin.thinned() is thin
    assert thin.count[:1001].sum() == 2001


def test_says_what_does_not_fit():
    q, moved, rest = motion(10, 0)
    with pytest.raises(DataError, match=r"expected \(10, 3\)"):
        tip_sums(ARM, q, moved[:9], rest)
    with pytest.raises(DataError, match="rest"):
        tip_sums(ARM, q, moved, np.zeros(3))
