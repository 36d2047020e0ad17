"""Errors hold whichever of several equally likely causes is the true one."""

import numpy as np
import pytest

from arm.base_parameters import BaseParameters
from arm.effects.catalogue import catalogue
from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.joint_hypotheses import JointHypothesis
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.model_averaging import averaged
from fitter.diagnosis.search import Cause, Search, supports
from fitter.search.fitted_parameter import FittedParameter
from tests.fitter.diagnosis.blocks import fit_of

ERROR = 0.1


def candidate(*effects: tuple[str, int]) -> Candidate:
    """Return a model of some joints' effects that was fitted to nothing."""
    model = Model()
    for name, joint in effects:
        hypothesis = JointHypothesis(catalogue()[name], joint)
        model = model.plus(hypothesis, np.zeros(len(hypothesis.low)))
    return Candidate(model, np.zeros(model.n_column), np.zeros(2))


def numbers(base: dict[str, float], *effects: float) -> Estimates:
    """Return base parameters and effects of one number each, with errors of one size."""
    names = BaseParameters(tuple(base), ("kg m^2",) * len(base), tuple(range(len(base))), np.eye(len(base)))
    parameters = tuple({"size": FittedParameter(value, ERROR, "N m", True)} for value in effects)
    std = np.full(len(base), ERROR)
    return Estimates(names, np.array(list(base.values())), std, parameters, np.zeros((0, 0)))


def searched(support: list[float]) -> tuple[Search, Candidate]:
    """Return a search that found two causes, the second of which has an equal, and that equal."""
    final, rival = (
        candidate(("joint_spring", 0), ("quadratic_drag", 0)),
        candidate(("joint_spring", 0), ("quadratic_drag", 1)),
    )
    base = candidate()
    causes = [Cause(0, base, final), Cause(1, base, final, [rival], support=support, beside=[rival])]
    return Search(base, final, causes, base, (), (), None, None), rival  # type: ignore[arg-type]


def test_a_number_that_differs_under_an_equal_is_less_sure():
    noise = np.random.default_rng(0).normal(size=400)
    search, rival = searched(supports([fit_of(noise, 1), fit_of(-noise, 1)]))
    own = {id(rival): numbers({"I": 3.0, "other": 1.0}, 1.5, 9.0)}
    found = averaged(search, numbers({"I": 2.0, "D": 1.0}, 1.0, 4.0), own)
    shared, alone = (one["size"].std for one in found.effects)
    # The mixture of two normal distributions, about the mean of one of them.
    draws = np.random.default_rng(1).normal(np.repeat([1.0, 1.5], 200_000), ERROR)
    assert shared == pytest.approx(np.sqrt(np.mean((draws - 1.0) ** 2)), rel=0.01)
    assert alone == ERROR
    assert found.std == pytest.approx([np.hypot(ERROR, np.sqrt(0.5)), ERROR])


def test_an_equal_that_agrees_widens_nothing():
    search, rival = searched([0.5, 0.5])
    found = averaged(search, numbers({"I": 2.0}, 1.0, 4.0), {id(rival): numbers({"I": 2.0}, 1.0, 9.0)})
    assert [one["size"].std for one in found.effects] == [ERROR, ERROR]
    assert found.std.tolist() == [ERROR]


def test_what_the_equal_does_not_determine_says_nothing():
    search, rival = searched([0.5, 0.5])
    found = averaged(search, numbers({"I": 2.0}, 1.0, 4.0), {id(rival): numbers({"I": np.nan}, np.nan, 9.0)})
    assert [one["size"].std for one in found.effects] == [ERROR, ERROR]
    assert found.std.tolist() == [ERROR]
