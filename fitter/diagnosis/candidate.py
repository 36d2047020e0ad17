"""A model with its factors, and what it leaves."""

from dataclasses import dataclass

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model


@dataclass(frozen=True)
class Candidate:
    """A fitted model.

    Attributes
    ----------
    model : Model
        What was accepted before, and a hypothesis as its last.
    x : (n_factor,)
        Base parameters and the columns' factors.
    squares : (n_trial,)
        Sum of squares that is left in each trial, in units of the noise.
    """

    model: Model
    x: Floats
    squares: Floats

    @property
    def hypothesis(self) -> Hypothesis:
        """What was added last."""
        return self.model.hypotheses[-1]
