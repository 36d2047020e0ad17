"""Where searches have come to: the same is not sought from the beginning again."""

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model


class Starts:
    """Values of psi from which a search has come far: when the same is sought anew, it begins there.

    Where only weights have changed, or the psi of what was accepted, the best of them has hardly moved.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[frozenset[Hypothesis], Hypothesis], Floats] = {}

    def of(self, model: Model, hypothesis: Hypothesis) -> Floats | None:
        """Return those of a hypothesis beside a model's, (n_start, n_psi); None if it was not tried there."""
        return self._known.get((frozenset(model.hypotheses), hypothesis))

    def keep(self, model: Model, hypothesis: Hypothesis, starts: Floats) -> None:
        """Keep those that did best."""
        self._known[frozenset(model.hypotheses), hypothesis] = starts

    def forget(self) -> None:
        """Forget all: they are of other trials."""
        self._known.clear()
