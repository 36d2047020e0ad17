"""What learning trials do not show: a stop that none of them reaches, a load that none of them carries."""

import numpy as np

from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate
from fitter.diagnosis.search import UNEXPLAINED

UNSEEN = "what is wrong shows in evaluating trials only, so causes were sought in all: the gain is no prediction"
#: Evaluating trials show what learning trials don't if they leave this much beyond noise of one, and those not
#: more than this.
_MUCH, _NOTHING = 0.3, 0.1


def shows_only_where_it_is_judged(regression: Regression, base: Candidate, found: Candidate) -> bool:
    """Say whether the learning trials fit a model, and the evaluating ones don't.

    Parameters
    ----------
    regression : Regression
    base, found : Candidate
        Without and with what was found. That no formula is exact may well show in evaluating trials only; but it
        is not too much for what was found to be all.
    """
    learnt, told = np.array([motion.learn for motion in regression.motions]), regression.told
    beyond, was = (float(one.squares.sum() - told.sum()) for one in (found, base))
    if regression.learns_from_all or beyond <= UNEXPLAINED * was:
        return False
    # What happened in single trials was fitted to all of them, and what else is in those bends the others' fit.
    by_learning = regression.squares(found.model, regression.solve(found.model, regression.learning))
    left = np.where(learnt, by_learning, found.squares)
    excess = [left[some].sum() / told[some].sum() - 1.0 for some in (learnt, ~learnt)]
    return bool(excess[1] > _MUCH and excess[0] < _NOTHING)
