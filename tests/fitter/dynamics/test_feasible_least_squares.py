"""The search among possible arms, held against closed forms, other searches and its own optimality conditions."""

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.arm_file import load_arm
from arm.physical_links import is_possible, pseudo_inertia
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.dynamics.feasible_least_squares import least_squares_possible

ARM = load_arm("dd-arm")
LINKS = standard_parameters(ARM)[:20].reshape(2, 10)
BASE = structural_parameters(ARM)
C = BASE.combination[:4, :20]
L1 = ARM.joints[0].a_m


def rod(mass, length):
    inertia = mass * length**2 / 3
    return [1e-3, inertia, inertia, 0, 0, 0, mass * length / 2, 0, 0, mass]


def slack(v):
    """Return what a flat two-joint arm needs to be above zero: some mass m2 must satisfy both of its links."""
    return v[0] * v[3] / L1**2 - v[1] ** 2 - v[2] ** 2


def flat_optimum(W, z):
    """Minimise over the closed form, from several starts."""
    best = None
    for start in ([2.0, 0.5, 0.0, 0.5], [5.0, 1.0, 1.0, 2.0], [1.0, -0.5, 0.2, 3.0], *[C @ LINKS.ravel()]):
        found = scipy.optimize.minimize(
            lambda v: np.sum((W @ v - z) ** 2),
            start,
            jac=lambda v: 2 * W.T @ (W @ v - z),
            method="SLSQP",
            bounds=[(0, None), (None, None), (None, None), (0, None)],
            constraints={"type": "ineq", "fun": slack},
            options={"ftol": 1e-14, "maxiter": 500},
        )
        if slack(found.x) > -1e-8 and (best is None or found.fun < best):
            best = found.fun
    return best


@pytest.mark.parametrize("seed", range(6))
def test_the_flat_arm_in_closed_form(seed):
    rng = np.random.default_rng(seed)
    W = rng.normal(size=(9, 4))
    z = W @ np.array([1.5, 1.7, 0.2, rng.uniform(-0.2, -0.05)]) + 0.1 * rng.normal(size=9)
    found = least_squares_possible(W @ C, z, LINKS, np.ones(0), 1e-9)
    v = C @ found.links.ravel()
    assert slack(v) > 0.0
    best = flat_optimum(W, z)
    assert best * (1 - 1e-7) - 1e-7 <= found.cost <= best + 1e-6
    assert found.cost > np.sum((W @ np.linalg.lstsq(W, z, rcond=None)[0] - z) ** 2) + 1e-4  # the bound matters


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), n_link=st.integers(1, 4), rows=st.integers(3, 30))
def test_the_optimality_conditions(seed, n_link, rows):
    """With Z = mu J^-1 as the multiplier only mu J0^-1 is left of the gradient; so the gap is what it says."""
    rng = np.random.default_rng(seed)
    nominal = np.array([rod(rng.uniform(0.5, 5), rng.uniform(0.2, 1)) for _ in range(n_link)])
    A, b = rng.normal(size=(rows, 10 * n_link + 2)), rng.normal(size=rows)
    found = least_squares_possible(A, b, nominal, np.ones(2), 1e-6)
    p = np.concatenate([found.links.ravel(), found.friction])
    gradient = 2 * A.T @ (A @ p - b)
    assert np.all(found.friction > 0.0)
    for i in range(n_link):
        J, J0 = pseudo_inertia(found.links[i]), pseudo_inertia(nominal[i])
        left = found.mu * (np.linalg.inv(J0) - np.linalg.inv(J))
        barrier = [np.sum(left * pseudo_inertia(unit)) for unit in np.eye(10)]
        here = gradient[10 * i : 10 * (i + 1)]
        size = np.abs(here).max() + np.abs(barrier).max() + 1e-3
        assert np.linalg.eigvalsh(J)[0] > 0.0
        assert np.allclose(here, -np.array(barrier), atol=2e-3 * size)
    assert np.allclose(
        gradient[-2:], found.mu * (1 / found.friction - 1), atol=1e-4 * (np.abs(gradient).max() + 1e-3)
    )


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), n_link=st.integers(1, 3))
def test_no_possible_arm_is_better_than_it_says(seed, n_link):
    rng = np.random.default_rng(seed)
    nominal = np.array([rod(rng.uniform(0.5, 5), rng.uniform(0.2, 1)) for _ in range(n_link)])
    A, b = rng.normal(size=(8, 10 * n_link + 1)), 3 * rng.normal(size=8)
    found = least_squares_possible(A, b, nominal, np.ones(1), 1e-4)
    near = [*found.links.ravel(), *found.friction]
    for _ in range(50):
        # possible ones of all sizes, and steps from the optimum towards them
        factor = rng.normal(size=(n_link, 4, 4)) * 10.0 ** rng.uniform(-2, 1)
        others = [_parameters(F @ F.T) for F in factor]
        rival = np.array([*np.ravel(others), rng.uniform(0, 2)])
        rival = near + rng.uniform(0, 1) ** 4 * (rival - near)
        heavy = sum(
            np.sum(np.linalg.inv(pseudo_inertia(n)) * pseudo_inertia(p))
            for n, p in zip(nominal, rival[:-1].reshape(-1, 10), strict=True)
        )
        margin = found.mu * (4 * n_link + 1 + heavy + rival[-1])
        assert np.sum((A @ rival - b) ** 2) >= found.cost - 1.001 * margin


def _parameters(J):
    turn = np.trace(J[:3, :3]) * np.eye(3) - J[:3, :3]
    return [turn[0, 0], turn[1, 1], turn[2, 2], turn[0, 1], turn[0, 2], turn[1, 2], *J[:3, 3], J[3, 3]]


def test_another_search_finds_nothing_better():
    """Log-Cholesky parameters and trust regions (Rucker and Wensing 2022), from several starts."""
    rng = np.random.default_rng(3)
    A = rng.normal(size=(12, 10))
    b = A @ np.array([0.1, 0.1, 0.5, 0, 0.1, 0, 0.4, 0, 0.2, 1.0])  # the triangle inequality fails
    found = least_squares_possible(A, b, np.array([rod(1.0, 0.6)]), np.ones(0), 1e-10)
    i, j = np.triu_indices(4)

    def residual(x):
        U = np.zeros((4, 4))
        U[i, j] = np.where(i == j, np.exp(np.clip(x, -30, 3)), x)
        return A @ _parameters(U @ U.T) - b

    costs = [
        2 * scipy.optimize.least_squares(residual, 0.3 * rng.normal(size=10), max_nfev=150).cost for _ in range(3)
    ]
    assert found.cost <= min(costs) + 1e-7
    assert found.cost == pytest.approx(min(costs), rel=1e-3)


def test_inside_the_cone_it_is_plain_least_squares():
    rng = np.random.default_rng(1)
    A = rng.normal(size=(30, 20))
    found = least_squares_possible(A, A @ LINKS.ravel(), 1.7 * LINKS[::-1], np.ones(0), 1e-12)
    assert np.allclose(found.links, LINKS, atol=1e-6)
    assert all(is_possible(p) for p in found.links)


def test_what_the_data_does_not_tell_stays_nominal():
    found = least_squares_possible(np.zeros((1, 21)), np.zeros(1), LINKS, np.full(1, 0.3), 1e-6)
    assert np.allclose(found.links, LINKS)
    assert found.friction[0] == pytest.approx(0.3)
