"""How far a pass of the smoother goes towards what it found, and whether it was the last one."""

import numpy as np

#: Passes end when no state moves by more than this fraction of its standard deviation, a convention: what is left
#: adds 0.04 % to its variance.
_CLOSE_ENOUGH = 0.02
#: A pass that moves the states by more than this fraction of the pass before gets no nearer, a convention.
_TOO_LITTLE = 0.7
#: The shortest step of a pass, as a share of what it found, a convention.
_SHORTEST = 0.25
#: Passes that swing about the answer also end after this number in a row, a convention, whose log-likelihoods
#: differ by less [nats]: half a nat is what one number costs that is a standard deviation off. Turn and place
#: of a sensor that no motion tells apart lie along a curve; what was held of them, along a straight line.
_EQUAL_PASSES, _EQUAL_NATS = 4, 0.5


class StepControl:
    """Follows the passes over one recording.

    Attributes
    ----------
    passes : int
    converged : bool
    step : float
        By what share of the way to what the last pass found the next one is linearised.
    """

    def __init__(self) -> None:
        self.passes, self.converged, self.step = 0, False, 1.0
        self._moved, self._cost, self._equal = np.inf, np.inf, 0

    def judge(self, moved: float, cost: float) -> bool:
        """Take note of a pass, and say whether the passes swing about the answer.

        Parameters
        ----------
        moved : float
            By how many of its standard deviations it moved a state at the most.
        cost : float
            Minus twice the logarithm of the likelihood.
        """
        before, cost_before, self._moved, self._cost = self._moved, self._cost, moved, cost
        self.passes += 1
        is_equal = self.step < 1.0 and abs(cost - cost_before) < 2.0 * _EQUAL_NATS
        self._equal = self._equal + 1 if is_equal else 0
        self.converged = moved < _CLOSE_ENOUGH or self._equal >= _EQUAL_PASSES
        swings = self.passes > 2 and moved > _TOO_LITTLE * before
        if swings:
            self.step = max(_SHORTEST, 0.5 * self.step)
        if moved < _CLOSE_ENOUGH:
            self.step = 1.0
        return swings

    def go_on(self) -> None:
        """Take note that what is smoothed has changed."""
        self.converged, self._moved, self._equal = False, np.inf, 0

    def begin_anew(self) -> None:
        """Take note that the motion was replaced by another one."""
        self.go_on()
        self.step = 1.0
