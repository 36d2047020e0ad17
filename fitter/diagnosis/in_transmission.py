"""Effects between the motor, where the angle is measured, and the link, whose motion the equation is about.

The motor's side has no inertia of its own, so the torque passes through it at once, and the link's angle is what
was measured less the twist that this torque causes. The twist passes the same filter as the angle did.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.data.derivatives import differentiate, lowpass
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.in_drive import lagging
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.view import View

#: Twists at the greatest torque that are tried first [rad].
_TWISTS = np.geomspace(1e-3, 0.3, 8)
_GAPS = np.geomspace(1e-3, 0.2, 8)
_SETTLING_S = (0.002, 0.02)
#: A torque within so many times its noise may have either sign.
_SIGMAS = 5.0


def side(torque: Floats, doubt: float) -> Floats:
    """Return where in its play a motor is, (n_sample,): from -1 to 1, 0 as long as nobody can tell.

    It touches the side towards which it pulls. A motor without inertia crosses the play as fast as its controller
    lets it, and meanwhile passes on no torque: the crossing takes as long as the torque cannot be told from zero.
    """
    sure = np.flatnonzero(np.abs(torque) > doubt)
    if not len(sure):
        return np.zeros(len(torque))
    return np.interp(np.arange(len(torque)), sure, np.sign(torque[sure]))


class InTransmission(Hypothesis):
    """Play (its gap), or elasticity (its compliance and the time in which it settles)."""

    @property
    def _play(self) -> bool:
        return self.kind.name == "backlash"

    @property
    def low(self) -> Floats:
        """Least values of psi."""
        return np.array([1e-6]) if self._play else np.array([1e-7, 1e-5])

    @property
    def high(self) -> Floats:
        """Greatest values of psi."""
        return np.array([1.0]) if self._play else np.array([1.0, 0.5])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values of psi to try first."""
        if self._play:
            return _GAPS[:, None]
        u = np.concatenate([np.abs(motion.u[:, self.joints[0]]) for motion in motions])
        compliance = _TWISTS / max(float(np.quantile(u, 0.99)), 1e-12)
        return np.array([[c, s] for c in compliance for s in _SETTLING_S])

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion whose link lags behind the measured angle by the twist."""
        j, dt_s = self.joints[0], view.motion.dt_s
        torque = view.u[:, j]
        if self._play:
            twist = 0.5 * psi[0] * side(torque, _SIGMAS * float(view.motion.u_noise[j]))
        else:
            twist = psi[0] * lagging(torque, float(psi[1]), dt_s)
        twist = lowpass(twist, dt_s, view.motion.corner_hz)
        q, dq, ddq = view.q.copy(), view.dq.copy(), view.ddq.copy()
        q[:, j] -= twist
        dq[:, j] -= differentiate(twist, dt_s)
        ddq[:, j] -= differentiate(twist, dt_s, 2)
        return replace(view, q=q, dq=dq, ddq=ddq)

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the gap, or stiffness and damping."""
        return np.array(psi) if self._play else np.array([1.0 / psi[0], psi[1] / psi[0]])
