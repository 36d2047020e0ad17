"""A motion's equations under a model; what two models in a row have in common is computed once.

What a search holds while it tries a hypothesis that acts further down leaves the motion as it was: every stage
keeps what follows from it.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from fitter.diagnosis.model import Hypothesis, Model
from fitter.diagnosis.motion import BaseColumns, Motion, View, view_of
from fitter.diagnosis.weighting import Columns, Rows, Weighting

By = tuple[Hypothesis, Floats] | None

#: What of a view the regressor is made of, but for a drift of friction and a gain, which only scale it.
_MOVES = ("arm", "q", "dq", "ddq", "direction")


class _LastTorque:
    """The torque that was last asked about at any stage of a motion, and its rows."""

    def __init__(self) -> None:
        self._known: tuple[Floats, Columns] | None = None

    def rows(self, u: Floats, made: Callable[[], Columns]) -> Columns:
        """Return the rows of a torque (n_sample, n_joint): those that are known if it is the same array."""
        if self._known is None or self._known[0] is not u:
            self._known = u, made()
        return self._known[1]


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
        self._base_at: dict[int, Columns] = {}
        self._columns_at: dict[int, tuple[Columns, ...]] = {}
        self.last_torque: _LastTorque = before.last_torque if before is not None else _LastTorque()

    def then(self, hypothesis: Hypothesis, psi: Floats) -> "Stage":
        """Return the motion under one hypothesis more."""
        by = hypothesis, np.array(psi)
        return Stage(self._sought, self._weighting, hypothesis.act(self.view, psi), self, by)

    @cached_property
    def base(self) -> Columns:
        """The base regressor's rows."""
        before, view = self._before, self.view
        if before is not None and self._is_same(*_MOVES, "drift", "factor"):
            return before.base
        if before is not None and self._is_same(*_MOVES, "drift"):
            return before.base.plus((more, before.base_at(joint)) for joint, more in self._scaled(before))
        if before is not None and self._is_same(*_MOVES, "factor"):
            grown = self._grown(before)
            return before.base.plus(((view.factor[joint] * more, rows) for joint, more, rows in grown))
        return self._white(view.base(self._sought.of(view.arm)))

    def base_at(self, joint: int) -> Columns:
        """Return what one joint's own equation makes of these rows, by itself, for a gain of 1."""
        before, view = self._before, self.view
        if before is not None and self._is_same(*_MOVES, "drift"):
            return before.base_at(joint)
        if joint not in self._base_at:
            if before is not None and self._is_same(*_MOVES):
                grown = ((more, rows) for one, more, rows in self._grown(before) if one == joint)
                self._base_at[joint] = before.base_at(joint).plus(grown)
            else:
                alone = replace(view, factor=(np.arange(view.q.shape[1]) == joint).astype(np.float64))
                self._base_at[joint] = self._white(alone.base(self._sought.of(view.arm)))
        return self._base_at[joint]

    def _scaled(self, before: "Stage") -> list[tuple[int, float]]:
        """Return joints that have another gain than before, and what their equations count more for that."""
        more = self.view.factor - before.view.factor
        return [(int(joint), float(more[joint])) for joint in np.flatnonzero(more)]

    def _grown(self, before: "Stage") -> Iterator[tuple[int, float, Columns]]:
        """Yield joints whose friction drifts more, by how much, and what that makes of the base."""
        for joint, more in enumerate(self.view.drift - before.view.drift):
            if more:
                yield joint, float(more), before.growing[joint]

    @cached_property
    def growing(self) -> list[Columns]:
        """What each joint's friction is in the base, times the run's time, for a gain of 1, and nothing else."""
        view, n = self.view, self.view.q.shape[1]
        kept = self._sought.of(view.arm)
        plain = replace(view, drift=np.zeros(n), factor=np.ones(n))
        rows = plain.base(kept) * np.maximum(view.motion.t, 0.0)[:, None, None]
        is_its = ((kept == 10 * n + j) | (kept == 11 * n + j) for j in range(n))
        return [self._white(rows * its) for its in is_its]

    @cached_property
    def columns(self) -> tuple[Columns, ...]:
        """All further columns' rows."""
        before, now = self._before, self.view
        if before is None:
            return ()
        first, factor = len(before.view.columns), now.factor
        if factor is not before.view.factor and first:
            at = [(more, before.columns_at(joint)) for joint, more in self._scaled(before)]
            return tuple(one.plus((more, rows[k]) for more, rows in at) for k, one in enumerate(before.columns))
        added = (self._white(one * factor[:, None]) for one in now.columns[first:])
        return (*before.columns, *added)

    def columns_at(self, joint: int) -> tuple[Columns, ...]:
        """Return what one joint's own equation makes of these, by itself, for a gain of 1."""
        before, now = self._before, self.view
        if before is None:
            return ()
        if joint not in self._columns_at:
            alone = (np.arange(now.q.shape[1]) == joint)[:, None]
            new = now.columns[len(before.view.columns) :]
            added = (self._white(one * alone) for one in new)
            self._columns_at[joint] = (*before.columns_at(joint), *added)
        return self._columns_at[joint]

    @cached_property
    def rows(self) -> Rows:
        """The motion's equations."""
        return Rows(self.all_columns, self.right, self.view.q.shape[1])

    @cached_property
    def all_columns(self) -> Columns:
        """Base and further columns side by side."""
        before = self._before
        if before is not None and self._goes_on_from(before):
            new = self.columns[len(before.columns) :]
            return before.all_columns.beside(*new) if new else before.all_columns
        return self.base.beside(*self.columns) if self.columns else self.base

    @cached_property
    def right(self) -> Columns:
        """The right-hand side."""
        before, known = self._before, self._sought.known
        if before is not None and self._is_same("u", *(() if known is None else (*_MOVES, "factor"))):
            return before.right
        if known is not None:
            return self._white(self.view.target(known)[:, :, None])
        u = self.view.u
        return self.last_torque.rows(u, lambda: self._white(u[:, :, None]))

    def _white(self, rows: Floats) -> Columns:
        white = self._weighting.whitened(self.view.motion, rows)
        return Columns(self._weighting, self.view.motion, white.reshape(-1, white.shape[2]))

    def _goes_on_from(self, before: "Stage") -> bool:
        """Say whether the rows are those before and maybe some more."""
        return self.base is before.base and all(a is b for a, b in zip(before.columns, self.columns, strict=False))

    def _is_same(self, *names: str) -> bool:
        """Say whether the last hypothesis has left some of the view as it was."""
        now, was = self.view, self._before.view if self._before is not None else None
        return was is not None and all(getattr(now, name) is getattr(was, name) for name in names)


class Equations:
    """The equations of motions, under any model.

    Parameters
    ----------
    arm : Arm
        Geometry, gravity, law.
    weighting : Weighting
    denied : tuple of str
        Beginnings of names of base parameters that are left out, such as ``D`` and ``fc``.
    known : (column, value), optional
        A standard parameter that is not sought: where no torque tells the scale of all the others, it does.
    """

    def __init__(
        self, arm: Arm, weighting: Weighting, denied: tuple[str, ...] = (), known: tuple[int, float] | None = None
    ) -> None:
        self.arm, self.weighting, self.denied, self.known = arm, weighting, denied, known
        self._sought = BaseColumns(arm, denied, known)
        self._stages: dict[int, list[Stage]] = {}

    def independent(self, arm: Arm) -> NDArray[np.intp]:
        """Return the columns of the standard regressor that stand for an arm's base parameters."""
        return self._sought.of(arm)

    def view(self, model: Model, motion: Motion) -> View:
        """Return a motion under a model, with the columns in the model's order."""
        return self._stage(model, motion).view

    def rows(self, model: Model, motion: Motion) -> Rows:
        """Return a motion's equations under a model, with the columns in the model's order."""
        return self._stage(model, motion).rows

    def design_at(self, model: Model, motion: Motion, joint: int) -> Floats:
        """Return what a joint's own equation makes of the design, by itself, for a gain of 1, shaped like it."""
        stage = self._stage(model, motion)
        return stage.base_at(joint).beside(*stage.columns_at(joint)).freed

    def left(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return the torque that factors leave, as it is on the motion's own grid, (n_sample, n_joint)."""
        view = self.view(model, motion)
        return view.target(self.known) - view.equations(self.independent(view.arm)) @ x

    def friction(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return the joints' viscous and Coulomb friction by a model's factors, (n_joint, 2)."""
        n = self.arm.n_joint
        kept = self.independent(self.view(model, motion).arm)
        standard = standard_parameters(self.arm)
        standard[kept] = x[: len(kept)]
        return np.stack([standard[10 * n : 11 * n], standard[11 * n :]], axis=1)

    def slopes(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return by how much the torque that is left falls with each factor and each psi, unfiltered.

        Returns
        -------
        (n_sample, n_joint, n_factor + n_psi)
        """
        view = self.view(model, motion)
        columns = [view.equations(self.independent(view.arm))]
        for *beside, apart in model.beside():
            more, less = (self.left(one, x, motion) for one in beside)
            columns.append((less - more)[..., None] / apart)
        return np.concatenate(columns, axis=2)

    def _stage(self, model: Model, motion: Motion) -> Stage:
        stages = self._stages.get(id(motion))
        if stages is None or stages[0].view.motion is not motion:  # another may have got its id
            stages = self._stages[id(motion)] = [Stage(self._sought, self.weighting, view_of(motion, self.arm))]
        for k, i in enumerate(model.downstream(), start=1):
            hypothesis, psi = model.hypotheses[i], model.psi[i]
            by = stages[k].by if k < len(stages) else None
            if by is None or by[0] is not hypothesis or not np.array_equal(by[1], psi):
                del stages[k:]
                stages.append(stages[-1].then(hypothesis, psi))
        return stages[len(model.hypotheses)]
