"""Causes that have no size go, where the others explain what there is."""

import numpy as np
import pytest

from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.search import Cause, Search
from fitter.diagnosis.untold import are_told, without_untold
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression() -> Regression:
    spring = Effect("joint_spring", {"stiffness_N_m_rad": 0.4, "rest_angle_rad": 0.1}, joints=(1,))
    trials = to_trials(swings((spring,), trials=8, seed=2), cutoff_hz=25.0)
    return Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))


def search_with(regression: Regression, *names: str) -> Search:
    tried = {one.kind.name: one for one in hypotheses(1, (), driven=True)}
    chosen: list[Hypothesis] = [tried[name] for name in names]
    psi = tuple(np.asarray(one.starts(regression.motions)[0]) if len(one.low) else np.zeros(0) for one in chosen)
    final = fitted(regression, Model(tuple(chosen), psi))
    told = np.array([regression.weighting.told(motion) for motion in regression.motions], dtype=np.float64)
    causes = [Cause(place) for place in range(len(names))]
    return Search(fitted(regression, Model()), final, causes, [], told)


def test_one_that_has_no_size_goes(regression: Regression) -> None:
    search = search_with(regression, "quadratic_drag", "joint_spring")
    found = estimates(regression, search.final)
    assert are_told(search.final.model, found) == [False, True]
    fewer = without_untold(regression, search, found)
    assert [one.kind.name for one in fewer.final.model.hypotheses] == ["joint_spring"]
    assert [cause.place for cause in fewer.causes] == [0]


def test_all_stay_where_all_have_a_size_or_none(regression: Regression) -> None:
    for names in (("joint_spring",), ("quadratic_drag",)):
        search = search_with(regression, *names)
        assert without_untold(regression, search, estimates(regression, search.final)) is search
