"""The models that a search for causes went through: one cause more at every step, all numbers fitted anew."""

from collections.abc import Mapping
from dataclasses import dataclass

from arm.model import Arm
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.diagnosis.estimates import estimates, extended_arm
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.regression import Model
from fitter.diagnosis.screening import fitted
from fitter.search.fitted_parameter import FittedParameter


@dataclass(frozen=True)
class Step:
    """A model with the first few causes.

    Attributes
    ----------
    hypothesis : Hypothesis or None
        The last of them; none in the first step.
    numbers : mapping from name to FittedParameter
        Of that cause, in the model with all causes.
    arm : Arm
        To be simulated, with the causes up to this one.
    """

    hypothesis: Hypothesis | None
    numbers: Mapping[str, FittedParameter]
    arm: Arm


def steps(found: Diagnosis) -> list[Step]:
    """Return the model without causes, then with one more at a time.

    Causes count here even where the verdict is ``unexplained``: the page says how far they carry.
    """
    regression, final = found.regression, found.search.final
    listed = [Step(None, {}, found.finding.base_arm)]
    numbers = estimates(regression, final).effects
    for k, hypothesis in enumerate(final.model.hypotheses, 1):
        model = fitted(regression, Model(final.model.hypotheses[:k], final.model.psi[:k]))
        arm = extended_arm(regression, model, estimates(regression, model))
        listed.append(Step(hypothesis, numbers[k - 1], arm))
    return listed
