"""A motion's equations on the slower grid, their noise white: their products without what may hold a joint.

What may hold a joint takes rows V to ``V - U diag(l) U'V``, with orthonormal axes U and what is lost along each,
l. Products of such rows are ``V'V - Z'Z`` with ``Z = diag(sqrt(l (2 - l))) U'V``, so one pass along the axes gives
them, and what a model leaves is freed as one column: the rows themselves seldom need be.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from arm.model import Floats
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.least_squares import ROUNDED
from fitter.diagnosis.motion import Motion


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
        """Products of the freed columns, (n_column, n_column); zero where next to nothing is left of one."""
        whole = self.white.T @ self.white
        left = whole - self.lost.T @ self.lost
        gone = np.diag(left) <= ROUNDED * np.diag(whole)
        left[gone], left[:, gone] = 0.0, 0.0
        return np.asarray(left, dtype=np.float64)

    def beside(self, *new: "Columns") -> "Columns":
        """Return these and new ones side by side: what is known of any of them is not worked out again."""
        parts = self, *new
        both = Columns(self._weighting, self._motion, np.hstack([one.white for one in parts]))
        if any("held" in one.__dict__ for one in parts):
            both.held = np.hstack([one.held for one in parts])
        return both

    def plus(self, more: Iterable[tuple[float, "Columns"]]) -> "Columns":
        """Return these with so many times others added."""
        parts = [(1.0, self), *more]
        both = Columns(self._weighting, self._motion, np.asarray(sum(k * one.white for k, one in parts)))
        both.held = np.asarray(sum(k * one.held for k, one in parts))
        return both

    def times(self, other: "Columns") -> Floats:
        """Return the freed columns' products with others, (n_column, n_other)."""
        products = self.white.T @ other.white - self.lost.T @ other.lost
        products[np.diag(self.gram) == 0.0] = 0.0
        return np.asarray(products, dtype=np.float64)

    def left_by(self, x: Floats, other: "Columns") -> "Columns":
        """Return what factors x (n_column,) leave of one other column."""
        left = Columns(self._weighting, self._motion, other.white - (self.white @ x)[:, None])
        if "held" in self.__dict__:
            left.held = other.held - (self.held @ x)[:, None]
        return left

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
    def pull(self) -> Floats:
        """The columns' products with the right-hand side, (n_factor,)."""
        return np.asarray(self.columns.times(self.right)[:, 0], dtype=np.float64)

    def left(self, x: Floats) -> Floats:
        """Return what factors (n_factor,) leave, (n_slower, n_joint)."""
        return self.columns.left_by(x, self.right).freed.reshape(-1, self.n_joint)

    def square(self, x: Floats) -> float:
        """Return the sum of squares of what factors (n_factor,) leave."""
        return float(self.columns.left_by(x, self.right).gram[0, 0])
