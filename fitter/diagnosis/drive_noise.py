"""How much of the noise a drive lets through: one that passes less torque leaves less of it.

Noise of the angles enters an equation times masses that are in proportion to the torque that is let through, so a
drive that is weak, late or cut off leaves less noise beside a smaller torque, and the fewer squares of it are no
evidence. Residuals under it therefore count in units of its own noise (`Regression.scale`).

The noise of a drive is compared with that of the same model whose drive is ideal, base parameters by least squares
and the columns' factors the same in both. So models that differ by a cause of no size are equally likely.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import NEGLIGIBLE, ROUNDED, TINY, UNEXPLAINED, compensated
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import HypotheticalMotion, Motion
from fitter.diagnosis.weighting import Rows


class Noise(Protocol):
    """What noise makes of equations (`errors_in_variables`)."""

    @property
    def gram(self) -> Floats:
        """Products of what it makes of the columns, (n, n_factor, n_factor)."""

    @property
    def rhs(self) -> Floats:
        """Their products with what it makes of the right-hand side, (n, n_factor)."""

    def sum_of_squares(self, x: Floats) -> Floats:
        """Return what it leaves of every joint under factors."""


class Equations(Protocol):
    """Equations of motions."""

    def hypothetical(self, model: Model, motion: Motion) -> HypotheticalMotion:
        """Return a motion under a model."""

    def rows(self, model: Model, motion: Motion) -> Rows:
        """Return a motion's equations under a model."""


#: Noise of some motions' equations under a model, joint by joint if that is asked for.
NoiseOf = Callable[[Model, Sequence[Motion], bool], Noise]


@dataclass(frozen=True)
class _System:
    """The normal equations of a model, and their noise.

    Attributes
    ----------
    gram : (n_factor, n_factor)
    rhs : (n_factor,)
    noise : Noise
        Of every joint.
    """

    gram: Floats
    rhs: Floats
    noise: Noise

    def noise_beside(self, factors: Floats) -> Floats:
        """Return the noise of every joint with given factors, the base parameters fitted, (n_joint,)."""
        n = len(self.rhs) - len(factors)
        gram, rhs = self.noise.gram.sum(axis=0), self.noise.rhs.sum(axis=0)
        x = compensated(
            self.gram[:n, :n],
            self.rhs[:n] - self.gram[:n, n:] @ factors,
            gram[:n, :n],
            rhs[:n] - gram[:n, n:] @ factors,
        )
        noise_sum = self.noise.sum_of_squares(np.concatenate([x, factors]))
        return np.asarray(np.maximum(noise_sum, TINY))


class DriveNoise:
    """The share of the noise that drives leave in the equations of some motions.

    Parameters
    ----------
    equations : Equations
    noise_of : callable
    motions : sequence of Motion
        The learning trials.
    """

    def __init__(self, equations: Equations, noise_of: NoiseOf, motions: Sequence[Motion]) -> None:
        self._equations, self._noise_of, self._motions = equations, noise_of, motions
        self._passed: dict[object, Floats] = {}
        self._ideal: tuple[object, _System] | None = None

    def share(self, model: Model, x: Floats, floor: Callable[[], Floats]) -> Floats:
        """Return which share of the noise's variance a model's drive leaves, (n_joint,).

        Parameters
        ----------
        model : Model
        x : (n_factor,)
        floor : callable
            Returns the sum of squares that is no noise, (n_joint,); asked for drives that distort.
        """
        share = self._let_through(model) if model.cuts_off else np.ones(self._motions[0].u.shape[1])
        if model.distorts:
            factors = x[len(x) - model.n_column :]
            beside = [np.full(one.n_column, not one.distorts) for one in model.hypotheses]
            own = self._system(model).noise_beside(factors)
            ideal = self._without_drive(model).noise_beside(factors[np.concatenate(beside)])
            beyond = floor()
            share = share * np.maximum((beyond + own) / (beyond + ideal), UNEXPLAINED)
        return np.asarray(share, dtype=np.float64)

    def _without_drive(self, model: Model) -> _System:
        """Return the equations with an ideal drive; what was asked about last is kept."""
        plain = model.undistorted()
        key = tuple((one, psi.tobytes()) for one, psi in zip(plain.hypotheses, plain.psi, strict=True))
        if self._ideal is None or self._ideal[0] != key:
            self._ideal = key, self._system(plain)
        return self._ideal[1]

    def _system(self, model: Model) -> _System:
        rows = [self._equations.rows(model, motion) for motion in self._motions]
        gram, rhs = sum(one.columns.gram for one in rows), sum(one.rhs for one in rows)
        return _System(np.asarray(gram), np.asarray(rhs), self._noise_of(model, self._motions, True))

    def _let_through(self, model: Model) -> Floats:
        key = tuple((one.key, psi.tobytes()) for one, psi in zip(model.hypotheses, model.psi, strict=True))
        if key not in self._passed:
            hypotheticals = [self._equations.hypothetical(model, motion) for motion in self._motions]
            self._passed[key] = let_through(hypotheticals, self._motions)
        return self._passed[key]


def let_through(hypotheticals: Sequence[HypotheticalMotion], motions: Sequence[Motion]) -> Floats:
    """Return the fraction of each joint's squared torque that a limit passes, (n_joint,).

    It counts as far as the limit is reached: of a torque that is cut off now and then nearly all noise stays.

    Parameters
    ----------
    hypotheticals : sequence of HypotheticalMotion
        Motions as they are under the limit.
    motions : sequence of Motion
        The same as measured.
    """
    asked, reaches, cut, moving = np.zeros((4, motions[0].u.shape[1]))
    for hypothetical, motion in zip(hypotheticals, motions, strict=True):
        moves = ~motion.stuck
        asked += np.sum(motion.u**2 * moves, axis=0)
        reaches += np.sum(hypothetical.u**2 * moves, axis=0)
        off = np.abs(hypothetical.u - motion.u) > NEGLIGIBLE * np.sqrt(np.mean(motion.u**2, axis=0))
        cut += np.sum(off & moves, axis=0)
        moving += np.sum(moves, axis=0)
    through = np.clip(reaches / np.maximum(asked, TINY), ROUNDED, 1.0)
    return np.asarray(through ** (cut / np.maximum(moving, 1.0)), dtype=np.float64)
