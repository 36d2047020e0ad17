"""Factors that a push in one trial does not bend."""

import numpy as np
import pytest

from arm.model import Effect
from fitter.diagnosis.robust_fit import robustly_fitted
from fitter.diagnosis.screening import screen
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.diagnosis.searched import swinging

#: In the first trial of three seconds: it may be learnt from.
PUSH = Effect("external_push", {"start_s": 1.0, "duration_s": 0.6, "torque_N_m": 6.0}, joints=(1,))


def fitted_base(*effects):
    likelihood = TorqueLikelihood(swinging(*effects), [], screen)
    base = likelihood.base().candidate
    return likelihood.regression, base


@pytest.fixture(scope="module")
def free():
    return fitted_base()[1].x


def test_a_push_has_little_say(free):
    regression, bent = fitted_base(PUSH)
    robust = robustly_fitted(regression, bent)
    bound = np.abs(free) + 0.01 * np.abs(free).max()
    assert np.max(np.abs(robust.x - free) / bound) < 0.4 * np.max(np.abs(bent.x - free) / bound)
    quiet = np.array([not (one.t[0] < 1.3 < one.t[-1]) for one in regression.motions])
    assert robust.squares[quiet].sum() < bent.squares[quiet].sum()


def test_where_nothing_is_lacking_nothing_is_weighed():
    regression, base = fitted_base()
    assert robustly_fitted(regression, base) is base
