"""The genetic algorithm on valleys, bounds, moving targets."""

import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.model import Floats
from fitter.search.genetic import GeneticAlgorithm, reflected, triangular_factor


def valley(n_gene: int, condition: float, seed: int) -> tuple[Floats, Floats]:
    """Return R and the optimum of a quadratic ``|R (x - optimum)|^2`` that is turned at random."""
    rng = np.random.default_rng(seed)
    axes, _ = np.linalg.qr(rng.normal(size=(n_gene, n_gene)))
    steepness = np.logspace(0.0, -0.5 * np.log10(condition), n_gene)
    return steepness[:, None] * axes.T, rng.uniform(-4.0, 4.0, n_gene)


def run(cost, lower, upper, seed, population=100, generations=1000):
    search = GeneticAlgorithm(lower, upper, np.random.default_rng(seed), population)
    for _ in range(generations):
        search.tell(cost(search.ask()))
    return search


@pytest.mark.parametrize("condition", [1.0, 1e10])
@pytest.mark.parametrize("n_gene", [2, 12])
def test_finds_the_bottom_of_a_narrow_valley(n_gene, condition):
    for seed in range(2):
        R, optimum = valley(n_gene, condition, seed)
        search = run(
            lambda x, R=R, o=optimum: np.sum(((x - o) @ R.T) ** 2, axis=1),
            np.full(n_gene, -5.0),
            np.full(n_gene, 5.0),
            seed,
        )
        assert search.best_cost < 1e-18
        assert np.allclose(search.best, optimum, rtol=1e-6)


def test_finds_a_bent_valley():
    for seed in range(2):
        rosenbrock = run(
            lambda x: np.sum(100 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1 - x[:, :-1]) ** 2, axis=1),
            np.full(4, -5.0),
            np.full(4, 5.0),
            seed,
        )
        assert np.allclose(rosenbrock.best, 1.0, atol=1e-9)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.integers(2, 6))
def test_keeps_bounds_and_fixed_genes(seed, n_gene):
    rng = np.random.default_rng(seed)
    lower = rng.normal(size=n_gene)
    upper = lower + rng.choice([0.0, 1.0, 10.0], n_gene)
    goal = lower + rng.normal(size=n_gene) * 5  # mostly out of bounds
    search = GeneticAlgorithm(lower, upper, rng, 20)
    for _ in range(30):
        people = search.ask()
        assert np.all((people >= lower) & (people <= upper))
        search.tell(np.sum((people - goal) ** 2, axis=1))
    assert np.all(people[:, lower == upper] == lower[lower == upper])


def test_finds_an_optimum_on_the_bounds():
    search = run(lambda x: np.sum((x - [6.0, -7.0, 1.0]) ** 2 * [1, 100, 1e-3], axis=1), [-5.0] * 3, [5.0] * 3, 0)
    assert np.allclose(search.best, [5.0, -5.0, 1.0], atol=1e-6)


def test_same_seed_same_bytes_and_the_best_is_never_lost():
    R, optimum = valley(6, 100.0, 3)
    seen = []
    for _ in range(2):
        search = GeneticAlgorithm(np.full(6, -5.0), np.full(6, 5.0), np.random.default_rng(8), 30)
        costs = []
        for _ in range(60):
            search.tell(np.sum(((search.ask() - optimum) @ R.T) ** 2, axis=1))
            costs.append(search.best_cost)
        assert np.all(np.diff(costs) <= 0.0)
        seen.append(search.ask().tobytes())
    assert seen[0] == seen[1]


def test_follows_an_optimum_that_moves():
    """As it does while data comes in: a population that has narrowed must widen again."""
    R, optimum = valley(6, 1e4, 0)
    search = GeneticAlgorithm(np.full(6, -5.0), np.full(6, 5.0), np.random.default_rng(0))
    for move in (0.0, 0.5, -0.5):
        goal = optimum + move
        for _ in range(500):
            search.tell(np.sum(((search.ask() - goal) @ R.T) ** 2, axis=1))
        assert np.allclose(search.best, goal, atol=1e-6)


def test_a_held_gene_waits_with_its_first_scatter():
    search = GeneticAlgorithm(np.full(3, -5.0), np.full(3, 5.0), np.random.default_rng(0))
    before = search.ask()[:, 2]
    search.hold(np.array([False, False, True]))
    for _ in range(100):
        search.tell(np.sum((search.ask()[:, :2] - 1.0) ** 2, axis=1))
    assert np.array_equal(search.ask()[:, 2], before)
    search.hold(np.zeros(3, dtype=bool))
    for _ in range(300):
        search.tell(np.sum((search.ask() - [1.0, 1.0, -3.0]) ** 2, axis=1))
    assert np.allclose(search.best, [1.0, 1.0, -3.0], atol=1e-9)


def test_costs_that_are_not_numbers_come_last():
    search = run(
        lambda x: np.where(x[:, 0] > 0.5, np.nan, np.sum(x**2, axis=1)),
        [-1.0, -1.0],
        [1.0, 1.0],
        0,
        generations=200,
    )
    assert np.allclose(search.best, 0.0, atol=1e-9)


def test_refuses_what_makes_no_sense():
    rng = np.random.default_rng(0)
    with pytest.raises(ValueError, match="ordered"):
        GeneticAlgorithm([1.0], [0.0], rng)
    with pytest.raises(ValueError, match="finite"):
        GeneticAlgorithm([-np.inf], [0.0], rng)
    with pytest.raises(ValueError, match="at least 10"):
        GeneticAlgorithm([0.0], [1.0], rng, 9)
    with pytest.raises(ValueError, match=r"expected \(10,\)"):
        GeneticAlgorithm([0.0], [1.0], rng, 10).tell(np.zeros(9))


def test_a_generation_is_worked_on_as_a_whole():
    """However many individuals there are, Python and numpy are entered equally often."""

    def entered(population):
        count = 0

        def seen(_frame, event, _argument):
            nonlocal count
            count += event in ("call", "c_call")

        search = GeneticAlgorithm(np.full(8, -5.0), np.full(8, 5.0), np.random.default_rng(0), population)
        search.tell(np.sum(search.ask() ** 2, axis=1))
        sys.setprofile(seen)
        try:
            search.tell(np.sum(search.ask() ** 2, axis=1))
        finally:
            sys.setprofile(None)
        return count

    assert 0 < entered(400) < 1.1 * entered(100)


@given(st.floats(-100.0, 100.0), st.floats(-2.0, 2.0), st.floats(0.01, 3.0))
def test_reflection_lands_inside(value, lower, width):
    inside = reflected(value, lower, lower + width)
    assert lower <= inside <= lower + width
    if lower <= value <= lower + width:
        assert np.isclose(inside, value, atol=1e-12)


@given(st.integers(1, 12), st.integers(1, 6), st.integers(0, 99))
def test_triangular_factor_keeps_the_products(n, k, seed):
    A = np.random.default_rng(seed).normal(size=(n, k))
    R = triangular_factor(A)
    assert np.allclose(R.T @ R, A.T @ A / n, atol=1e-12)
    assert np.array_equal(R, np.triu(R))
