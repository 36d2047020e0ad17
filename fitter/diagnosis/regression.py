"""Base parameters and hypotheses fitted together, by least squares on white rows.

The columns' factors and the base parameters follow from psi by linear least squares, so only psi is searched
(`refinement`). What was learnt from the learning trials is then held against trials that it has not seen.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.diagnosis.drive_noise import DriveNoise
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.errors_in_variables import Noise, NoiseProducts, noisier
from fitter.diagnosis.least_squares import Normal, compensated
from fitter.diagnosis.model import BARE, Model
from fitter.diagnosis.motion import HypotheticalMotion, Motion
from fitter.diagnosis.motion_cells import cells_of
from fitter.diagnosis.weighting import Rows, Weighting


class Density(Protocol):
    """What keeps masses from being made small (`mass_density`)."""

    def of(self, model: Model, x: Floats, motions: Sequence[Motion]) -> float:
        """Return its logarithm [nats]."""

    def along(self, model: Model, motions: Sequence[Motion]) -> Callable[[Floats], float]:
        """Return its logarithm as a function of the factors."""

    def unit(self, model: Model, x: Floats, motions: Sequence[Motion], numbers: float) -> float:
        """Return by how much residuals count more for it."""

    def slopes(self, model: Model, x: Floats, motions: Sequence[Motion]) -> tuple[Floats, Floats]:
        """Return its slopes with factors and psi, and its information of them."""

    def solve(self, normal: Normal, numbers: float, x: Floats, model: Model, motions: Sequence[Motion]) -> Floats:
        """Return the likeliest factors."""


class RestLimits(Protocol):
    """What no rest may ask of friction (`rests`)."""

    def beyond(self, model: Model, x: Floats, motions: Sequence[Motion]) -> list[Floats]:
        """Return by how much limits are exceeded."""

    def places(self, motion: Motion) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return joint and middle sample of each limit."""

    def likeliest(
        self,
        density: Density,
        normal: Normal,
        numbers: float,
        x: Floats,
        model: Model,
        motions: Sequence[Motion],
        free: NDArray[np.bool_],
    ) -> Floats:
        """Return the likeliest factors if rests have a say."""


class Regression:
    """The equations of a run, under any model.

    Parameters
    ----------
    arm : Arm
        Geometry, gravity, law.
    motions : sequence of Motion
        Learning ones first.
    weighted : Weighting
        The filter that makes the noise white.
    denied : tuple of str
        Beginnings of names of base parameters that are left out, such as ``D`` and ``fc``.
    known : (column, value), optional
        A standard parameter that is not sought: where no torque determines the scale of all the others, it does.
    given : Model
        What acts in addition to every model, see `Equations`.
    """

    def __init__(
        self,
        arm: Arm,
        motions: Sequence[Motion],
        weighted: Weighting,
        denied: tuple[str, ...] = (),
        known: tuple[int, float] | None = None,
        given: Model = BARE,
    ) -> None:
        self.arm = arm
        self.motions = list(motions)
        self.denied = denied
        self.noisier = noisier(arm, self.motions)
        self.equations = Equations(arm, weighted, denied, known, given)
        #: The sensors' noise alone, where no more is known of the masses.
        self.sensors = weighted
        #: Which part of the equations' variance is no noise of the sensors (`error_floor`), 0 to 1.
        self.floor_part = 0.0
        #: The share of the noise that is left by the drive of the model by which the equations are weighed.
        self.own_share = np.ones(arm.n_joint)
        #: Where joints rest, if something is lacking.
        self.rests: RestLimits | None = None
        #: Of the motions, where something moves them that the model lacks.
        self.density: Density | None = None
        self._noisy = NoiseProducts(self.equations, self.noisier)
        self._drives = DriveNoise(self.equations, self._noisy.of, self.learning)
        weighted.prepare(self.motions)

    @cached_property
    def learning(self) -> list[Motion]:
        """The trials that may be learnt from."""
        return [motion for motion in self.motions if motion.learn]

    @cached_property
    def _cells(self) -> dict[int, NDArray[np.intp]]:
        every = cells_of(self.motions)
        return {motion.number: one for motion, one in zip(self.motions, every, strict=True)}

    def cells(self, motion: Motion) -> NDArray[np.intp]:
        """Return where in its motion every joint is, at every row (n_slower, n_joint), see `motion_cells`."""
        return self._cells[motion.number][:: self.weighting.stride]

    def cells_at(self, motion: Motion, samples: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the same at some samples, (n, n_joint)."""
        return self._cells[motion.number][samples]

    def motions_of(self, model: Model) -> list[Motion]:
        """Return the trials that a model is fitted to: all of them if it has something that single ones have."""
        return self.motions if model.is_event else self.learning

    @property
    def weighting(self) -> Weighting:
        """The filter that makes the noise white."""
        return self.equations.weighting

    @property
    def n_effective(self) -> Floats:
        """Effective number of observations of each trial, (n_trial,): the expected chi2 of noise alone."""
        return np.array([self.weighting.n_effective(motion) for motion in self.motions], dtype=np.float64)

    def weighted_by(self, weighted: Weighting) -> "Regression":
        """Return a regression of the same motions with another filter, and no density."""
        known, given = self.equations.known, self.equations.given
        other = Regression(self.arm, self.motions, weighted, self.denied, known, given)
        other.sensors = self.sensors
        return other

    def hypothetical(self, model: Model, motion: Motion) -> HypotheticalMotion:
        """Return a motion under a model."""
        return self.equations.hypothetical(model, motion)

    def rows(self, model: Model, motion: Motion) -> Rows:
        """Return a motion's equations under a model."""
        return self.equations.rows(model, motion)

    def noise(self, model: Model, motions: Sequence[Motion]) -> Noise:
        """Return what a draw of noise makes of some motions' equations under a model."""
        return self._noisy.of(model, motions)

    @contextmanager
    def by_torque_alone(self) -> Iterator[None]:
        """Let neither the motions' density nor rests count within."""
        density, rests = self.density, self.rests
        self.density = self.rests = None
        try:
            yield
        finally:
            self.density, self.rests = density, rests

    def solve(self, model: Model, motions: Sequence[Motion], noise: Noise | None = None) -> Floats:
        """Return the best factors of some motions' equations, (n_factor,).

        The noise is that of `noise`, unless it is given.
        """
        rows = [self.rows(model, motion) for motion in motions]
        noise = noise or self.noise(model, motions)
        gram, rhs = sum(one.columns.gram for one in rows), sum(one.rhs for one in rows)
        x = compensated(np.asarray(gram), np.asarray(rhs), noise.gram.sum(axis=0), noise.rhs.sum(axis=0))
        if self.density is None:
            return x
        square = sum(float(one.right.gram[0, 0]) for one in rows)
        normal = Normal(np.asarray(gram), np.asarray(rhs), square)
        driving = np.zeros(len(x), dtype=np.bool_)
        coulomb = self._coulomb(model, motions[0], len(x))
        while True:  # dry friction brakes: of joints that it would drive it is none
            x = self._likeliest(normal, np.where(driving, 0.0, x), model, motions, ~driving)
            if not np.any(more := coulomb & ~driving & (x < 0.0)):
                return np.where(driving, 0.0, x)
            driving |= more

    def _coulomb(self, model: Model, motion: Motion, n_factor: int) -> NDArray[np.bool_]:
        """Say which factors of a model are base parameters of dry friction, (n_factor,)."""
        kept = self.equations.independent(self.hypothetical(model, motion).arm)
        # Ten numbers of every link, viscous friction of every joint, then its dry friction.
        return np.pad(kept >= 11 * self.arm.n_joint, (0, n_factor - len(kept)))

    def _likeliest(
        self, normal: Normal, x: Floats, model: Model, motions: Sequence[Motion], free: NDArray[np.bool_]
    ) -> Floats:
        """Return the likeliest factors where something is lacking; those that are not free stay at none."""
        assert self.density is not None
        numbers = self._numbers(motions)
        x = self.density.solve(normal.of(free), numbers, x, model, motions)
        if self.rests is None:
            return x
        return self.rests.likeliest(self.density, normal, numbers, x, model, motions, free)

    def _numbers(self, motions: Sequence[Motion]) -> float:
        return sum(self.weighting.n_effective(motion) for motion in motions)

    def residuals(self, model: Model, x: Floats, motions: Sequence[Motion]) -> Floats:
        """Return the residuals of some motions' equations, one after the other, in units of the noise.

        Its sum of squares is least where the motions are likeliest: with a residual of any variance, that is where
        ``log sum r^2 - 2 w sum log |det M| / n`` is, so each counts exp(-w sum log |det M| / n).
        """
        scale = self.scale(model, x)
        if self.density is not None:
            scale = scale * self.density.unit(model, x, motions, self._numbers(motions))
        return np.concatenate([(scale * self.rows(model, motion).residual(x)).ravel() for motion in motions])

    def residuals_with_limits(self, model: Model, x: Floats, motions: Sequence[Motion]) -> Floats:
        """Return the same, followed by what rests exceed their limits by."""
        unit = 1.0 if self.density is None else self.density.unit(model, x, motions, self._numbers(motions))
        at_rest = (unit * one.ravel() for one in self.beyond(model, x, motions))
        return np.concatenate([self.residuals(model, x, motions), *at_rest])

    def squares(self, model: Model, x: Floats, motions: Sequence[Motion] | None = None) -> Floats:
        """Return the sum of squares that factors leave in every trial, or in some, (n_trial,), rests included."""
        scale = self.scale(model, x)
        rows = (self.rows(model, motion) for motion in motions or self.motions)
        at_rest = [float(np.sum(one**2)) for one in self.beyond(model, x, motions or self.motions)]
        if np.all(scale == 1.0):
            return np.array([one.sum_of_squares(x) for one in rows]) + at_rest
        return np.array([float(np.sum((scale * one.residual(x)) ** 2)) for one in rows]) + at_rest

    def beyond(self, model: Model, x: Floats, motions: Sequence[Motion]) -> list[Floats]:
        """Return by how much rests exceed what friction can hold, in units of the noise, (n_row, n_joint) each.

        Every row is that of one joint; there are none where nothing is lacking.
        """
        if self.rests is None:
            return [np.zeros((0, self.arm.n_joint)) for _ in motions]
        scale, found = self.scale(model, x), list[Floats]()
        for motion, size in zip(motions, self.rests.beyond(model, x, motions), strict=True):
            rows = np.zeros((len(size), self.arm.n_joint))
            joint, _ = self.rests.places(motion)
            rows[np.arange(len(size)), joint] = scale[joint] * size
            found.append(rows)
        return found

    def residual(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return the residual of a motion's equations, (n_slower, n_joint), in units of the noise."""
        return np.asarray(self.scale(model, x) * self.rows(model, motion).residual(x), dtype=np.float64)

    def scale(self, model: Model, x: Floats) -> Floats:
        """Return by how much residuals of a model count more because it leaves less noise in them, (n_joint,).

        Less than the model by which they are weighed: its own have the variance that they are expected to.
        """
        return np.asarray(1.0 / np.sqrt(self.noise_share(model, x) / self.own_share))

    def noise_share(self, model: Model, x: Floats) -> Floats:
        """Return which share of the noise's variance a model's drive leaves, (n_joint,), see `drive_noise`."""
        return self._drives.share(model, x, self._floor_squares)

    def _floor_squares(self) -> Floats:
        """Return the sum of squares in the learning trials that is no noise of the sensors, (n_joint,)."""
        counts = [self.weighting.n_effective_at_joints(motion) for motion in self.learning]
        return np.asarray(self.floor_part * np.sum(counts, axis=0))

    @contextmanager
    def forgetting(self) -> Iterator[None]:
        """Forget the noise that was computed within: it is that of the first psi that was tried.

        What is tried in any order, or in several processes, then comes to the same.
        """
        known = dict(self._noisy.known)
        try:
            yield
        finally:
            self._noisy.known = known
