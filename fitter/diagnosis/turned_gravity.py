"""A tilt turns gravity: in the plane of motion it is no stronger than it is in space, unless the data says so.

What a model lacks is often made up for by more gravity than there is. A component in the plane that exceeds the
whole of it, by less than half of its interval, is therefore set to the whole; only its direction is sought then.
"""

from dataclasses import replace

import numpy as np

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.diagnosis.estimates import Estimates
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.in_arm import GravityTilt
from fitter.diagnosis.model import Model
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.view import View
from limbcal.digits import NORMAL_95


class TurnedGravity(Hypothesis):
    """All of gravity is in the plane; psi is its direction there [rad].

    Parameters
    ----------
    kind : EffectKind
    gravity : (3,) [m/s^2]
        As the arm file has it.
    """

    def __init__(self, kind: EffectKind, gravity: Floats) -> None:
        super().__init__(kind, ())
        self._gravity = gravity

    @property
    def low(self) -> Floats:
        """Least value, (1,)."""
        return np.array([-2.0 * np.pi])

    @property
    def high(self) -> Floats:
        """Greatest value, (1,)."""
        return np.array([2.0 * np.pi])

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion in another gravity."""
        x, y = self._gravity[:2] + self.numbers(psi, np.zeros(0))
        return replace(view, arm=replace(view.arm, gravity_m_s2=(float(x), float(y), float(self._gravity[2]))))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the two components that the arm file does not know of."""
        whole = np.linalg.norm(self._gravity) * np.array([np.cos(psi[0]), np.sin(psi[0])])
        return np.asarray(whole - self._gravity[:2], dtype=np.float64)


def turned(regression: Regression, model: Model, numbers: Estimates) -> Model | None:
    """Return a model, to be refined, whose tilt only turns gravity; None where it does so already.

    Parameters
    ----------
    regression : Regression
    model : Model
    numbers : Estimates
        Of that model.
    """
    for k, (hypothesis, found) in enumerate(zip(model.hypotheses, numbers.effects, strict=True)):
        if not isinstance(hypothesis, GravityTilt):
            continue
        gravity = np.array(regression.arm.gravity_m_s2)
        whole, inside = float(np.linalg.norm(gravity)), gravity[:2] + model.psi[k]
        strength = float(np.hypot(*inside))
        errors = np.array([number.std for number in found.values()])
        error = float(np.hypot(*(errors * inside / strength))) if strength else 0.0
        if whole and whole < strength < whole + NORMAL_95 * error:
            direction = np.array([np.arctan2(inside[1], inside[0])])
            turning = TurnedGravity(hypothesis.kind, gravity)
            hypotheses = (*model.hypotheses[:k], turning, *model.hypotheses[k + 1 :])
            psi = (*model.psi[:k], direction, *model.psi[k + 1 :])
            return Model(hypotheses, psi)
    return None
