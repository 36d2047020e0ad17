"""The stepwise search with the torque's likelihood: what is hidden is found, and nothing where nothing is."""

import numpy as np

from arm.model import Effect
from fitter.diagnosis.hypotheses import hypotheses
from fitter.diagnosis.stepwise import Stepwise
from fitter.diagnosis.torque.search import TorqueSearch
from tests.fitter.diagnosis.torque.runs import likelihood


def _found(effects=()):
    tried = [one for one in hypotheses(1) if one.kind.place == "joint"]
    search = TorqueSearch(likelihood(effects), tried)
    return search, Stepwise(search, len(tried)).run()


def test_a_hidden_effect_is_the_only_cause():
    search, found = _found((Effect("quadratic_drag", {"drag_N_m_s2": 0.3}, joints=(1,)),))
    assert [step.hypothesis.kind.name for step in found.steps] == ["quadratic_drag"]
    np.testing.assert_allclose(found.final.x[-1], 0.3, rtol=0.1)
    assert search.is_possible(found.final)


def test_nothing_is_found_where_nothing_is_hidden():
    _, found = _found()
    assert found.steps == ()
    assert found.final is found.base
