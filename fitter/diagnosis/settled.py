"""What was held, or left free, while causes were sought, is settled once they are known."""

from fitter.diagnosis.estimates import Estimates, estimates
from fitter.diagnosis.model import Model
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import Candidate, fitted
from fitter.diagnosis.turned_gravity import turned


def settled(regression: Regression, final: Candidate) -> tuple[Candidate, Estimates]:
    """Return a model with its pushes' times refined too, in a gravity no stronger than it is, and its numbers.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        With all causes that were found.
    """
    model = Model()
    for hypothesis, psi in zip(final.model.hypotheses, final.model.psi, strict=True):
        one, start = hypothesis, psi
        if isinstance(hypothesis, Pushes):
            one = Pushes(hypothesis.kind, hypothesis.joints[0], hypothesis.found, free=True)
            start = one.starts([])[0]
        model = model.plus(one, start)
    if len(model.flat) > len(final.model.flat):
        final = fitted(regression, model)
    numbers = estimates(regression, final)
    turning = turned(regression, final.model, numbers)
    if turning is None:
        return final, numbers
    final = fitted(regression, turning)
    return final, estimates(regression, final)
