"""What a function leaves, by sums of products, against designs that are solved one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.data.trials import to_trials
from fitter.diagnosis.basis_functions import BasisFunctions, symbolic_terms
from fitter.diagnosis.cross_validation import CrossValidation, typical
from fitter.diagnosis.error_floor import regression_of
from fitter.diagnosis.least_squares import scaled_lstsq
from fitter.diagnosis.model import Model
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.run import run_of
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression() -> Regression:
    trials = to_trials(swings((), trials=10, seed=3), cutoff_hz=25.0)
    return regression_of(pendulum(), run_of(pendulum(), trials[:5], trials[5:]))


def left(regression: Regression, features: list[np.ndarray], ridge: float = 0.0) -> float:
    """Return what columns beside the base parameters leave in trials of every eighth fold."""
    rows = [regression.rows(Model(), motion) for motion in regression.motions]
    filtered_at = regression.weighting.filtered_at
    columns = [filtered_at(motion, 0, one) for motion, one in zip(regression.motions, features, strict=True)]
    designs = [np.hstack([one.design, column]) for one, column in zip(rows, columns, strict=True)]
    targets = [one.target.ravel() for one in rows]
    size = np.linalg.norm(np.vstack(columns), axis=0)
    held = np.hstack([np.zeros((len(size), rows[0].design.shape[1])), np.diag(np.sqrt(ridge) * size)])
    squares = np.empty(len(rows))
    for k in range(8):
        learnt = [i for i in range(len(rows)) if i % 8 != k]
        design = np.vstack([*(designs[i] for i in learnt), held])
        x = scaled_lstsq(design, np.concatenate([*(targets[i] for i in learnt), np.zeros(len(held))]))
        for i in set(range(len(rows))) - set(learnt):
            squares[i] = np.sum((targets[i] - designs[i] @ x) ** 2)
    return typical(squares, np.array([regression.weighting.n_effective(motion) for motion in regression.motions]))


def test_a_function_of_one_variable(regression):
    fold, functions = (
        CrossValidation(regression, fitted(regression, Model())),
        BasisFunctions(regression.motions, 1),
    )
    assert fold.typical_chi2 == pytest.approx(
        left(regression, [np.zeros((len(m.t), 1)) for m in regression.motions])
    )
    splines = [functions.b_splines(motion, ("q1",)) for motion in regression.motions]
    assert fold.typical(("q1",), 0) == pytest.approx(left(regression, splines, ridge=1e-4), rel=1e-4)


def test_the_best_of_all_products(regression):
    fold = CrossValidation(regression, fitted(regression, Model()))
    features = [symbolic_terms(motion, ("q1", "dq1")) for motion in regression.motions]
    one_by_one = [
        left(regression, [columns[:, k : k + 1] for columns in features]) for k in range(features[0].shape[1])
    ]
    n_effective = np.array([regression.weighting.n_effective(motion) for motion in regression.motions])
    judged = [typical(squares, n_effective) for squares in fold._terms_judged(("q1", "dq1"), 0).T]
    assert judged == pytest.approx(one_by_one, rel=1e-6)


RATIOS = st.lists(st.floats(0.1, 100.0), min_size=1, max_size=30)


def test_what_is_typical_is_not_moved_far_by_one_trial():
    squares = np.full(20, 200.0)
    assert typical(squares, np.full(20, 100.0)) == pytest.approx(2.0)
    squares[7] *= 1e4
    assert typical(squares, np.full(20, 100.0)) == pytest.approx(2.0 * 1e4**0.05)


@given(RATIOS, st.floats(0.1, 10.0), st.permutations(range(30)))
def test_it_lies_among_them_in_any_order_and_unit(ratios, factor, order):
    n_effective = np.linspace(50.0, 90.0, len(ratios))
    squares = np.array(ratios) * n_effective
    found = typical(squares, n_effective)
    assert min(ratios) * (1.0 - 1e-9) <= found <= max(ratios) * (1.0 + 1e-9)
    assert typical(factor * squares, n_effective) == pytest.approx(factor * found)
    some = [k for k in order if k < len(ratios)]
    assert typical(squares[some], n_effective[some]) == pytest.approx(found)


def test_a_trial_that_is_left_with_nothing_is_no_exception():
    assert 0.0 < typical(np.array([0.0, 1.0]), np.ones(2)) < 1.0
