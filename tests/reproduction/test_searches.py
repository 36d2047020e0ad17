"""The searches that Fig. 6 compares, on costs whose optimum is known."""

import numpy as np
import pytest

from reproduction.searches import SEARCHES, Problem, trace

TRUE = np.array([0.3, -1.2, 0.8])


def bowl(genes):
    """Return the residuals of a bent valley, zero at TRUE only."""
    x = genes - TRUE
    return np.column_stack([x[:, 0] + 0.3 * x[:, 1] ** 2, 3.0 * x[:, 1], x[:, 2] + x[:, 0] * x[:, 1]])


def box(budget: int, goal: float = 0.0) -> Problem:
    return Problem(bowl, np.full(3, -2.0), np.full(3, 2.0), budget, goal)


@pytest.mark.parametrize("name", SEARCHES)
def test_each_finds_the_bottom_of_a_smooth_valley(name):
    problem = box(60_000, 1e-9)
    run = trace(SEARCHES[name], problem, np.array([-0.5, -0.7, 0.2]), seed=1)
    assert run.best[-1] <= 1e-9
    assert np.all(np.diff(run.best) <= 0.0)
    assert np.all(np.diff(run.evaluations) > 0)


@pytest.mark.parametrize("name", SEARCHES)
def test_none_goes_on_when_its_evaluations_are_used_up(name):
    problem = box(250)
    run = trace(SEARCHES[name], problem, np.array([1.5, 1.5, -1.5]), seed=1)
    assert run.evaluations[-1] < 250 + 150  # a generation that has begun is finished


@pytest.mark.parametrize("name", SEARCHES)
def test_the_same_seed_walks_the_same_way(name):
    runs = [trace(SEARCHES[name], box(2000), np.array([1.0, 0.0, -1.0]), seed=7).best for _ in range(2)]
    np.testing.assert_array_equal(*runs)


def test_an_answer_outside_the_box_is_none():
    problem = Problem(bowl, np.full(3, -1.0), np.full(3, 1.0), 100)
    problem.evaluate(TRUE)  # its second gene lies outside
    assert problem.best == [np.inf]
    problem.evaluate(np.array([[0.3, -1.0, 0.8], [0.0, 0.0, 0.0]]))
    assert problem.best[-1] == pytest.approx(np.sum(bowl(np.array([[0.3, -1.0, 0.8]])) ** 2))
    assert problem.evaluations == [1, 3]
