"""A candidate is told by what was added last."""

import numpy as np

from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.model import Model
from tests.fitter.diagnosis.linear import Columns


def test_its_hypothesis_is_the_last():
    first, second = Columns(0), Columns(1)
    model = Model().plus(first, np.zeros(0)).plus(second, np.zeros(0))
    assert Candidate(model, np.zeros(2), np.ones(3)).hypothesis is second
    assert Candidate(model.without(1), np.zeros(1), np.ones(3)).hypothesis is first
