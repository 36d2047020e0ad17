"""A motion's equations under the first hypotheses of a model, as far as possible by those under one fewer."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.base_columns import BaseColumns
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.view import View

By = tuple[Hypothesis, Floats] | None

#: What of a view the regressor is made of, but for a drift of friction and a gain, which only scale it.
_MOVES = ("arm", "q", "dq", "ddq", "direction")


class Stage:
    """A motion under the first hypotheses of a model.

    Parameters
    ----------
    sought : BaseColumns
    weighting : Weighting
    view : View
        The motion as it is under them.
    before : Stage, optional
        The same without the last of them.
    by : (Hypothesis, (n_psi,)), optional
        The last of them, with its psi.
    """

    def __init__(
        self, sought: BaseColumns, weighting: Weighting, view: View, before: "Stage | None" = None, by: By = None
    ) -> None:
        self._sought, self._weighting, self.view, self._before, self.by = sought, weighting, view, before, by
        self._base_at: dict[int, Floats] = {}
        self._columns_at: dict[int, tuple[Floats, ...]] = {}

    def then(self, hypothesis: Hypothesis, psi: Floats) -> "Stage":
        """Return the motion under one hypothesis more."""
        by = hypothesis, np.array(psi)
        return Stage(self._sought, self._weighting, hypothesis.act(self.view, psi), self, by)

    @cached_property
    def base(self) -> Floats:
        """The base regressor's rows."""
        before, view = self._before, self.view
        if before is not None and self._is_same(*_MOVES, "drift", "factor"):
            return before.base
        if before is not None and self._is_same(*_MOVES, "drift"):
            return before.base + sum(more * before.base_at(joint) for joint, more in self._scaled(before))
        if before is not None and self._is_same(*_MOVES, "factor"):
            base = before.base.copy()
            for joint, at, more in self._grown(before):
                base[:, :, at] += view.factor[joint] * more
            return base
        return self._weighting.filtered(view.motion, view.base(self._sought.of(view.arm)))

    def base_at(self, joint: int) -> Floats:
        """Return what one joint's own equation makes of these rows, by itself, for a gain of 1."""
        before, view = self._before, self.view
        if before is not None and self._is_same(*_MOVES, "drift"):
            return before.base_at(joint)
        if joint not in self._base_at:
            if before is not None and self._is_same(*_MOVES):
                rows = before.base_at(joint).copy()
                for at, more in ((at, more) for one, at, more in self._grown(before) if one == joint):
                    rows[:, :, at] += more
                self._base_at[joint] = rows
            else:
                alone = replace(view, factor=(np.arange(view.q.shape[1]) == joint).astype(np.float64))
                self._base_at[joint] = self._weighting.filtered(view.motion, alone.base(self._sought.of(view.arm)))
        return self._base_at[joint]

    def _scaled(self, before: "Stage") -> list[tuple[int, float]]:
        """Return joints that have another gain than before, and what their equations count more for that."""
        more = self.view.factor - before.view.factor
        return [(int(joint), float(more[joint])) for joint in np.flatnonzero(more)]

    def _grown(self, before: "Stage") -> Iterator[tuple[int, NDArray[np.intp], Floats]]:
        """Yield joints whose friction drifts more, where it is in the base, and what is added there."""
        for joint, more in enumerate(self.view.drift - before.view.drift):
            if more:
                at, growing = before.growing[joint]
                yield joint, at, more * growing

    @cached_property
    def growing(self) -> list[tuple[NDArray[np.intp], Floats]]:
        """Where each joint's friction is in the base, and its rows times the run's time, for a gain of 1."""
        view, n = self.view, self.view.q.shape[1]
        kept = self._sought.of(view.arm)
        plain = replace(view, drift=np.zeros(n), factor=np.ones(n))
        rows = plain.base(kept) * np.maximum(view.motion.t, 0.0)[:, None, None]
        places = [np.flatnonzero((kept == 10 * n + j) | (kept == 11 * n + j)) for j in range(n)]
        return [(at, self._weighting.filtered(view.motion, rows[:, :, at])) for at in places]

    @cached_property
    def columns(self) -> tuple[Floats, ...]:
        """All further columns' rows."""
        before, now = self._before, self.view
        if before is None:
            return ()
        first, factor = len(before.view.columns), now.factor
        if factor is not before.view.factor and first:
            at = [(more, before.columns_at(joint)) for joint, more in self._scaled(before)]
            return tuple(one + sum(more * rows[k] for more, rows in at) for k, one in enumerate(before.columns))
        filtered = self._weighting.filtered
        added = (filtered(now.motion, one * factor[:, None]) for one in now.columns[first:])
        return (*before.columns, *added)

    def columns_at(self, joint: int) -> tuple[Floats, ...]:
        """Return what one joint's own equation makes of these, by itself, for a gain of 1."""
        before, now = self._before, self.view
        if before is None:
            return ()
        if joint not in self._columns_at:
            alone = (np.arange(now.q.shape[1]) == joint)[:, None]
            new = now.columns[len(before.view.columns) :]
            added = (self._weighting.filtered(now.motion, one * alone) for one in new)
            self._columns_at[joint] = (*before.columns_at(joint), *added)
        return self._columns_at[joint]

    @cached_property
    def design(self) -> Floats:
        """Base and further columns side by side."""
        before = self._before
        if before is not None and self.base is before.base and len(self.columns) == len(before.columns):
            return before.design  # what changes columns changes the base
        both = np.concatenate([self.base, *self.columns], axis=2)
        return np.asarray(both.reshape(-1, both.shape[2]), dtype=np.float64)

    @cached_property
    def target(self) -> Floats:
        """The right-hand side's rows."""
        before, known = self._before, self._sought.known
        if before is not None and self._is_same("u", *(() if known is None else (*_MOVES, "factor"))):
            return before.target
        return self._weighting.filtered(self.view.motion, self.view.target(known))

    def _is_same(self, *names: str) -> bool:
        """Say whether the last hypothesis has left some of the view as it was."""
        now, was = self.view, self._before.view if self._before is not None else None
        return was is not None and all(getattr(now, name) is getattr(was, name) for name in names)
