"""The equation of motion of a whole run, weighted so that its noise is white (`whitening`).

While a joint is stuck its friction is not known, and a torque that jumps does so between two samples: unknown
torques j there, of a few shapes each (`whitening`) and of known variance, make the noise's covariance
``I + sum j j^T``, so with the singular values s of all of them, equations count ``1 / sqrt(1 + s^2)`` times along
each of their axes. Those of any size are eliminated from both sides, which costs their information and
leaves the noise of everything else white.

A motion's equations on the slower grid, their noise white: their products without what may hold a joint.

What may hold a joint takes rows V to ``V - U diag(l) U'V``, with orthonormal axes U and what is lost along each,
l. Products of such rows are ``V'V - Z'Z`` with ``Z = diag(sqrt(l (2 - l))) U'V``, so one pass along the axes gives
them, and what a model leaves is freed as one column: the rows themselves seldom need be.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.fft
import scipy.linalg

from arm.model import Floats
from fitter.diagnosis.least_squares import ROUNDED, orthonormal, singular
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.whitening import Whitening, end_shapes, holding_shapes, jump_shapes, rest_shapes
from fitter.parallel.forked import side_by_side


@dataclass(frozen=True)
class Weighting(Whitening):
    """The filter that makes the noise of a run white, and takes out what may hold a joint.

    Attributes
    ----------
    holding : mapping of int to (n_sample, n_joint) [N m or N]
        Standard deviation of what may hold each joint, by the motions' numbers; inf, or no entry, where it is
        unknown.
    """

    holding: Mapping[int, Floats]
    _held: dict[int, tuple[Floats, Floats]] = field(default_factory=dict, init=False, repr=False)
    _n_effective: dict[int, Floats] = field(default_factory=dict, init=False, repr=False)

    def filtered(self, motion: Motion, rows: Floats) -> Floats:
        """Return rows (n_sample, n_joint, …), filtered and on the slower grid, without what may hold a joint."""
        white = self.whitened(motion, rows)
        return self.freed(motion, white.reshape(white.shape[0] * white.shape[1], -1)).reshape(white.shape)

    def filtered_at(self, motion: Motion, joint: int, torques: Floats) -> Floats:
        """Return the same of torques (n_sample, n_column) at one joint, (n_slower * n_joint, n_column)."""
        return self.freed(motion, self.whitened_at(motion, joint, torques))

    def whitened_at(self, motion: Motion, joint: int, torques: Floats) -> Floats:
        """Return the same with what may hold a joint."""
        white = self.white(torques[:, None], motion.dt_s, slice(joint, joint + 1))
        return white.reshape(-1, torques.shape[1])

    def whitened(self, motion: Motion, rows: Floats) -> Floats:
        """Return rows (n_sample, n_joint, …), filtered and on the slower grid, with what may hold a joint."""
        acts = [joint for joint in range(rows.shape[1]) if np.any(rows[:, joint])]
        only = slice(acts[0], acts[0] + 1) if len(acts) == 1 else slice(None)
        return self.white(rows[:, only], motion.dt_s, only)

    def freed(self, motion: Motion, flat: Floats, held: Floats | None = None) -> Floats:
        """Return white rows (n_slower * n_joint, n_column) without what may hold a joint.

        Parameters
        ----------
        motion : Motion
        flat : (n_slower * n_joint, n_column)
        held : (n_axis, n_column), optional
            The same along `axes`, where it is known.
        """
        axes, lost = self.axes(motion)
        along = self.along(motion, flat) if held is None else held
        # Of several columns the same product the other way round takes twice as long.
        return np.asarray(flat - ((lost[:, None] * along).T @ axes.T).T, dtype=np.float64)

    def along(self, motion: Motion, flat: Floats) -> Floats:
        """Return white rows (n_slower * n_joint, n_column) along `axes`, (n_axis, n_column)."""
        # The other way round the same product takes a quarter longer: few columns are read in a row.
        return np.asarray((flat.T @ self.axes(motion)[0]).T, dtype=np.float64)

    def prepare(self, motions: Sequence[Motion]) -> None:
        """Work out what may hold the joints in all motions, and their effective numbers, on all processors."""
        unknown = [motion for motion in motions if motion.number not in self._n_effective]
        found = side_by_side(lambda motion: (self.axes(motion), self.n_effective_at_joints(motion)), unknown)
        for motion, (axes, numbers) in zip(unknown, found, strict=True):
            self._held[motion.number], self._n_effective[motion.number] = axes, numbers

    def n_effective(self, motion: Motion) -> float:
        """Return the effective number of observations of a motion's equations."""
        return float(np.sum(self.n_effective_at_joints(motion)))

    def n_effective_at_joints(self, motion: Motion) -> Floats:
        """Return the same joint by joint, (n_joint,): what is eliminated counts where it would have been seen."""
        if motion.number not in self._n_effective:
            axes, lost = self.axes(motion)
            rows = axes.reshape(-1, motion.q.shape[1], axes.shape[1])
            size = scipy.fft.next_fast_len(2 * len(rows), real=True)
            band = self.band(scipy.fft.rfftfreq(size, self.stride * motion.dt_s))
            # The noise is band-limited, so an axis beside the band has next to none of it to lose.
            seen = scipy.fft.irfft(band[:, None, None] * scipy.fft.rfft(rows, size, axis=0), size, axis=0)
            gone = np.sum(seen**2, axis=0) @ (1.0 - (1.0 - lost) ** 2)
            self._n_effective[motion.number] = self.n_in_band(len(rows), motion.dt_s) - gone
        return self._n_effective[motion.number]

    def axes(self, motion: Motion) -> tuple[Floats, Floats]:
        """Return orthonormal axes of what is not known of the torque, filtered, and how much of each is lost."""
        if motion.number not in self._held:
            anyhow, roughly = self._unknown(motion)
            held = orthonormal(anyhow)
            U, size = singular(roughly - held @ (held.T @ roughly))
            lost = np.concatenate([np.ones(held.shape[1]), 1.0 - 1.0 / np.sqrt(1.0 + size**2)])
            # In this order their products with few columns take three quarters of the time.
            self._held[motion.number] = np.asfortranarray(np.hstack([held, U])), lost
        return self._held[motion.number]

    def _unknown(self, motion: Motion) -> tuple[Floats, Floats]:
        """Return torques that may have any size, and those of one standard deviation, filtered, one a column."""
        n, n_joint = motion.q.shape
        ends = end_shapes(n, motion.dt_s)
        anyhow = [_at(j, ends, n_joint) for j in range(n_joint)]
        roughly = [jump_shapes(motion.jumps, n, n_joint)]
        holding = self.holding.get(motion.number, np.full(motion.q.shape, np.inf))
        for j, size in enumerate(holding.T):
            shapes = holding_shapes(motion.stuck[:, j], motion.dt_s)
            if np.all(np.isfinite(size)):
                roughly.append(_at(j, size[:, None] * shapes, n_joint))
                shapes = rest_shapes(motion.stuck[:, j], motion.dt_s)
            anyhow.append(_at(j, shapes, n_joint))
            anyhow.append(_at(j, holding_shapes(motion.contradicted[:, j], motion.dt_s), n_joint))
            if (std := motion.trial.target_std) is not None:
                roughly.append(_at(j, np.full((n, 1), std[j]), n_joint))
        white = (self.white(np.concatenate(part, axis=2), motion.dt_s) for part in (anyhow, roughly))
        first, second = (rows.reshape(rows.shape[0] * n_joint, rows.shape[2]) for rows in white)
        return first, second


def _at(joint: int, torques: Floats, n_joint: int) -> Floats:
    """Return torques (n_sample, n_torque) at one joint as rows of all of them, (n_sample, n_joint, n_torque)."""
    rows = np.zeros((len(torques), n_joint, torques.shape[1]))
    rows[:, joint] = torques
    return rows


class Columns:
    """White columns of a motion's equations.

    Parameters
    ----------
    weighting : Weighting
    motion : Motion
    white : (n_slower * n_joint, n_column)
        With what may hold a joint.
    """

    def __init__(self, weighting: Weighting, motion: Motion, white: Floats) -> None:
        self._weighting, self._motion, self.white = weighting, motion, white

    @cached_property
    def held(self) -> Floats:
        """The same along the axes of what may hold a joint, (n_axis, n_column)."""
        return self._weighting.along(self._motion, self.white)

    @cached_property
    def lost(self) -> Floats:
        """What is lost of their products, as a factor of them, (n_axis, n_column)."""
        lost = self._weighting.axes(self._motion)[1]
        return np.asarray(np.sqrt(lost * (2.0 - lost))[:, None] * self.held, dtype=np.float64)

    @cached_property
    def freed(self) -> Floats:
        """The columns without what may hold a joint, (n_slower * n_joint, n_column)."""
        return self._weighting.freed(self._motion, self.white, self.held)

    @cached_property
    def gram(self) -> Floats:
        """Products of the freed columns, (n_column, n_column); zero where next to nothing is reduced of one."""
        whole = self.white.T @ self.white
        reduced = whole - self.lost.T @ self.lost
        gone = np.diag(reduced) <= ROUNDED * np.diag(whole)
        reduced[gone], reduced[:, gone] = 0.0, 0.0
        return np.asarray(reduced, dtype=np.float64)

    def hstacked(self, *new: "Columns") -> "Columns":
        """Return these and new ones side by side: what is known of any of them is not worked out again."""
        parts = self, *new
        both = Columns(self._weighting, self._motion, np.hstack([one.white for one in parts]))
        if any("held" in one.__dict__ for one in parts):
            both.held = np.hstack([one.held for one in parts])
        return both

    def plus(self, more: Iterable[tuple[float, "Columns"]]) -> "Columns":
        """Return these with multiples of others added."""
        parts = [(1.0, self), *more]
        both = Columns(self._weighting, self._motion, np.asarray(sum(k * one.white for k, one in parts)))
        both.held = np.asarray(sum(k * one.held for k, one in parts))
        return both

    def times(self, other: "Columns") -> Floats:
        """Return the freed columns' products with others, (n_column, n_other)."""
        products = self.white.T @ other.white - self.lost.T @ other.lost
        products[np.diag(self.gram) == 0.0] = 0.0
        return np.asarray(products, dtype=np.float64)

    def residual_of(self, x: Floats, other: "Columns") -> "Columns":
        """Return the residual of one other column under factors x (n_column,)."""
        residual = Columns(self._weighting, self._motion, other.white - (self.white @ x)[:, None])
        if "held" in self.__dict__:
            residual.held = other.held - (self.held @ x)[:, None]
        return residual

    def noise_in(self, louder: "Columns", kept: Floats) -> "Columns":
        """Return what noise makes of them, from the same with more of it; none of columns not kept (0 or 1)."""
        noise = Columns(self._weighting, self._motion, (louder.white - self.white) * kept)
        noise.held = (louder.held - self.held) * kept
        return noise


@dataclass(frozen=True)
class Rows:
    """A motion's equations on the slower grid, ``design x = target``, noise white with variance 1.

    Attributes
    ----------
    columns : Columns
        The base parameters', and then all others; the same object as long as nothing has changed in them.
    right : Columns
        One: the torque.
    n_joint : int
    """

    columns: Columns
    right: Columns
    n_joint: int

    @property
    def design(self) -> Floats:
        """The columns, (n_slower * n_joint, n_factor)."""
        return self.columns.freed

    @property
    def target(self) -> Floats:
        """The right-hand side, (n_slower, n_joint)."""
        return self.right.freed.reshape(-1, self.n_joint)

    @cached_property
    def rhs(self) -> Floats:
        """The columns' products with the right-hand side, (n_factor,)."""
        return np.asarray(self.columns.times(self.right)[:, 0], dtype=np.float64)

    def residual(self, x: Floats) -> Floats:
        """Return the residual under factors (n_factor,), (n_slower, n_joint)."""
        return self.columns.residual_of(x, self.right).freed.reshape(-1, self.n_joint)

    def sum_of_squares(self, x: Floats) -> float:
        """Return the residual's sum of squares under factors (n_factor,)."""
        return float(self.columns.residual_of(x, self.right).gram[0, 0])
