"""What follows from a search: sizes that are told roughly, and sizes that cannot be."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.cancellation import is_cancelled
from fitter.diagnosis.causes import find_causes
from fitter.diagnosis.conclusion import concluded
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.search import Search
from fitter.diagnosis.unknown import describe
from tests.fitter.pendulum import pendulum, swings


def searched(name: str, numbers: dict[str, float]) -> tuple[Regression, Search]:
    trials = to_trials(swings((Effect(name, numbers, joints=(1,)),), trials=8, seed=2), cutoff_hz=25.0)
    regression = Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    return regression, find_causes(regression, [AtJoint(catalogue()[name], 0)])


@pytest.fixture(scope="module")
def sprung() -> tuple[Regression, Search]:
    return searched("joint_spring", {"stiffness_N_m_rad": 1.0, "rest_angle_rad": 0.2})


def with_factors(regression: Regression, candidate: Candidate, times: float) -> Candidate:
    """Return a candidate whose cause has other factors, and what it then leaves."""
    x = candidate.x * np.where(np.arange(len(candidate.x)) < len(candidate.x) - 2, 1.0, times)
    return replace(candidate, x=x, squares=regression.squares(candidate.model, x))


def test_a_true_cause_that_was_learnt_roughly_is_named(sprung: tuple[Regression, Search]) -> None:
    regression, search = sprung
    rough = replace(search, final=with_factors(regression, search.final, 1.1))
    assert describe(regression, rough.final).worth > 1.0, "as it is it leaves much that a function explains"
    assert concluded(regression, rough, strict=True).verdict == "named"


def test_fitted_to_all_trials_a_model_leaves_less_in_all(sprung: tuple[Regression, Search]) -> None:
    regression, search = sprung
    for model in (Model(), search.final.model):
        assert fitted(regression, model, to_all=True).squares.sum() <= fitted(regression, model).squares.sum()


def test_a_cause_that_makes_many_times_the_torque_there_is_is_none(sprung: tuple[Regression, Search]) -> None:
    regression, search = sprung
    assert not is_cancelled(regression, search.final)
    assert not is_cancelled(regression, search.base)
    assert is_cancelled(regression, with_factors(regression, search.final, 100.0))
