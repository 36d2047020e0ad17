"""What was held, or left free, while causes were sought, is settled once they are known."""

from fitter.diagnosis.estimates import Estimates, estimates
from fitter.diagnosis.pushes import with_free_times
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
    model = with_free_times(final.model)
    if len(model.flat) > len(final.model.flat):
        final = fitted(regression, model)
    numbers = estimates(regression, final)
    turning = turned(regression, final.model, numbers)
    if turning is None:
        return final, numbers
    final = fitted(regression, turning)
    return final, estimates(regression, final)
