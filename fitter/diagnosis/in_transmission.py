"""Effects between the motor, where the angle is measured, and the link, whose motion the equation is about.

The motor's side has no inertia of its own, so the torque passes through it at once, and the link's angle is what
was measured less the twist that this torque causes. The torque has passed the same filter as the angle, and so has
the twist. Friction acts on the link, which may still go one way while its motor goes the other.
"""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import erf

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.data.derivatives import both_derivatives
from fitter.diagnosis.in_drive import lagging
from fitter.diagnosis.least_squares import ROUNDED, TINY
from fitter.diagnosis.model import Hypothesis, Turn
from fitter.diagnosis.motion import Motion, View
from fitter.diagnosis.play import Play, play_of


class InTransmission(Hypothesis):
    """Something that lets the link's angle differ from the motor's."""

    #: Twists at the greatest torque, and gaps, that are tried first [rad].
    twists = np.geomspace(1e-3, 0.3, 8)

    @abstractmethod
    def change(self, view: View, psi: Floats) -> Floats:
        """Return by how much the link's angle and its derivatives differ from the motor's, (3, n_sample)."""

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion whose link lags behind the measured angle."""
        j = self.joints[0]
        change = self.change(view, psi)
        q, dq, ddq = view.q.copy(), view.dq.copy(), view.ddq.copy()
        for column, added in zip((q, dq, ddq), change, strict=True):
            column[:, j] += added
        direction = view.direction.copy()
        seen = _direction(view.motion.speed[:, j] + change[1], view.motion.speed_noise[:, j])
        direction[:, j] = np.where(view.motion.stuck[:, j], 0.0, seen)
        return replace(view, q=q, dq=dq, ddq=ddq, direction=direction)


class Backlash(InTransmission):
    """Play: its gap."""

    turn = Turn.PLAY
    stride = 0.05  # a crossing that a gap is just too small for is another path

    def __init__(self, kind: EffectKind, joints: Sequence[int]) -> None:
        super().__init__(kind, joints)
        self._known: dict[tuple[int, int], Play] = {}

    @property
    def low(self) -> Floats:
        """Least gap, (1,)."""
        return np.array([1e-6])

    @property
    def high(self) -> Floats:
        """Greatest gap, (1,)."""
        return np.array([1.0])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return gaps to try first, (n_start, 1)."""
        return self.twists[:, None]

    def change(self, view: View, psi: Floats) -> Floats:
        """Return by how much the link's angle and its derivatives differ from the motor's, (3, n_sample)."""
        return self._play(view).change(float(psi[0]))

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion whose link lags behind the measured angle, and coasts while the motor crosses."""
        return replace(super().act(view, psi), guessed=view.guessed | self._play(view).crosses)

    def _play(self, view: View) -> Play:
        key = view.motion.number, len(view.motion.t)
        if key not in self._known:
            self._known[key] = play_of(view.arm, view.motion, self.joints[0])
        return self._known[key]

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the gap."""
        return np.array(psi)


class Elasticity(InTransmission):
    """A spring: its compliance and the time in which it settles."""

    #: Times in which a spring settles that are tried first [s].
    settling_s = (0.002, 0.02)
    feels_torque = True

    @property
    def low(self) -> Floats:
        """Least values of psi, (2,)."""
        return np.array([1e-7, 1e-5])

    @property
    def high(self) -> Floats:
        """Greatest values of psi, (2,)."""
        return np.array([1.0, 0.5])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values of psi to try first, (n_start, 2)."""
        u = np.concatenate([np.abs(motion.u[:, self.joints[0]]) for motion in motions])
        compliance = self.twists / max(float(np.quantile(u, 0.99)), ROUNDED)
        return np.array([[c, s] for c in compliance for s in self.settling_s])

    def change(self, view: View, psi: Floats) -> Floats:
        """Return by how much the link's angle and its derivatives differ from the motor's, (3, n_sample)."""
        dt_s = view.motion.dt_s
        twist = psi[0] * lagging(view.arrived[:, self.joints[0]], float(psi[1]), dt_s)
        return -np.stack([twist, *both_derivatives(twist, dt_s)])

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return stiffness and damping."""
        return np.array([1.0 / psi[0], psi[1] / psi[0]])


def _direction(speed: Floats, noise: Floats) -> Floats:
    """Return what is expected of a velocity's sign, by its noise and by how much it changes within a sample."""
    spread = np.maximum(noise, 0.5 * np.abs(np.gradient(speed)))
    return np.asarray(erf(speed / (np.sqrt(2.0) * np.maximum(spread, TINY))), dtype=np.float64)
