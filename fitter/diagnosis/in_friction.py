"""Friction of a joint that changes as the run goes on: the regressor's own columns do."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.view import View

#: Rates that are tried first [1/s].
_RATES = (-0.005, 0.005, 0.05)


class FrictionDrift(Hypothesis):
    """Viscous and Coulomb friction of one joint grow alike with the run's time."""

    is_gradual = True
    is_inertial = False
    nothing = (0.0,)

    @property
    def low(self) -> Floats:
        """Least value, (1,)."""
        return np.array([self.kind.parameters[0].low])

    @property
    def high(self) -> Floats:
        """Greatest value, (1,)."""
        return np.array([self.kind.parameters[0].high])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first, (n_start, 1)."""
        return np.array(_RATES)[:, None]

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion whose friction drifts."""
        drift = view.drift.copy()
        drift[self.joints[0]] += psi[0]
        return replace(view, drift=drift)

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the rate."""
        return np.array(psi)
