"""Hypotheses of the transmission, between the motor's measured angle and the link that moves.

The motor's side has no inertia of its own, so the torque passes through it at once, and the link's angle is what
was measured less the twist that this torque causes. The torque has passed the same filter as the angle, and so has
the twist. Friction acts on the link, which may still go one way while its motor goes the other.
"""

import functools
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import erf

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.data.derivatives import both_derivatives
from fitter.diagnosis.backlash import BacklashPath, backlash_path
from fitter.diagnosis.drive_hypotheses import lagging
from fitter.diagnosis.free_link import FreeLink
from fitter.diagnosis.least_squares import ROUNDED, TINY
from fitter.diagnosis.model import ActionOrder, Hypothesis
from fitter.diagnosis.motion import HypotheticalMotion, Motion


class TransmissionHypothesis(Hypothesis):
    """Something that lets the link's angle differ from the motor's."""

    #: Twists at the greatest torque, and gaps, that are tried first [rad]: from what an encoder of 16 bits tells.
    twists = np.geomspace(2.0 * np.pi / 2**16, 0.3, 10)

    @abstractmethod
    def change(self, hypothetical: HypotheticalMotion, psi: Floats) -> Floats:
        """Return by how much the link's angle and its derivatives differ from the motor's, (3, n_sample)."""

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion whose link lags behind the measured angle."""
        j = self.joints[0]
        change = self.change(hypothetical, psi)
        q, dq, ddq = hypothetical.q.copy(), hypothetical.dq.copy(), hypothetical.ddq.copy()
        for column, added in zip((q, dq, ddq), change, strict=True):
            column[:, j] += added
        direction = hypothetical.direction.copy()
        seen = _direction(hypothetical.motion.speed[:, j] + change[1], hypothetical.motion.speed_noise[:, j])
        direction[:, j] = np.where(hypothetical.motion.stuck[:, j], 0.0, seen)
        return replace(hypothetical, q=q, dq=dq, ddq=ddq, direction=direction)


class Backlash(TransmissionHypothesis):
    """Backlash: its gap."""

    turn = ActionOrder.BACKLASH
    stride = 0.05  # a crossing that a gap is just too small for is another path

    def __init__(self, kind: EffectKind, joints: Sequence[int]) -> None:
        super().__init__(kind, joints)
        self._known: dict[tuple[int, int], BacklashPath] = {}
        self._links: dict[int, FreeLink | None] = {}

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

    def change(self, hypothetical: HypotheticalMotion, psi: Floats) -> Floats:
        """Return by how much the link's angle and its derivatives differ from the motor's, (3, n_sample)."""
        return self._play(hypothetical).change(float(psi[0]))

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion whose link lags behind the measured angle, and coasts while the motor crosses."""
        return replace(
            super().act(hypothetical, psi), guessed=hypothetical.guessed | self._play(hypothetical).crosses
        )

    def follow(self, links: Callable[[Motion, int], FreeLink | None], motions: Sequence[Motion]) -> None:
        """Let the link coast as a fitted model says."""
        self._links = {motion.number: links(motion, self.joints[0]) for motion in motions}
        self._known.clear()

    def _play(self, hypothetical: HypotheticalMotion) -> BacklashPath:
        motion = hypothetical.motion
        key = motion.number, len(motion.t)
        if key not in self._known:
            link = self._links.get(motion.number)
            self._known[key] = backlash_path(hypothetical.arm, motion, self.joints[0], link)
        return self._known[key]

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the gap."""
        return np.array(psi)


class Elasticity(TransmissionHypothesis):
    """A spring: its compliance and the time in which it settles."""

    #: Times in which a spring settles that are tried first [s].
    settling_s = (0.002, 0.02)
    depends_on_torque = True

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

    def change(self, hypothetical: HypotheticalMotion, psi: Floats) -> Floats:
        """Return by how much the link's angle and its derivatives differ from the motor's, (3, n_sample)."""
        torque = hypothetical.arrived[:, self.joints[0]]
        return np.asarray(-psi[0] * _unit_twist(torque.tobytes(), float(psi[1]), hypothetical.motion.dt_s))

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return stiffness and damping."""
        return np.array([1.0 / psi[0], psi[1] / psi[0]])

    def psi_of(self, numbers: Floats) -> Floats:
        """Return compliance and settling time."""
        return np.array([1.0 / numbers[0], numbers[1] / numbers[0]])


@functools.lru_cache(maxsize=256)
def _unit_twist(torque: bytes, settling_s: float, dt_s: float) -> Floats:
    """Return what a torque twists a spring of compliance 1, and its derivatives, (3, n_sample).

    A motion pushed by another acceleration has the same torque (`mass_density`, `friction_limits`), and so has one
    whose compliance alone differs. The size holds every run's twists while slopes are taken.
    """
    twist = lagging(np.frombuffer(torque), settling_s, dt_s)
    return np.stack([twist, *both_derivatives(twist, dt_s)])


def _direction(speed: Floats, noise: Floats) -> Floats:
    """Return what is expected of a velocity's sign, by its noise and by how much it changes within a sample."""
    spread = np.maximum(noise, 0.5 * np.abs(np.gradient(speed)))
    return np.asarray(erf(speed / (np.sqrt(2.0) * np.maximum(spread, TINY))), dtype=np.float64)
