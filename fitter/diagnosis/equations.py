"""A motion's equations under a model, with a cached transform for every hypothesis.

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
from fitter.diagnosis.model import BARE, Hypothesis, Model
from fitter.diagnosis.motion import BaseColumns, HypotheticalMotion, Motion, as_measured
from fitter.diagnosis.weighting import Columns, Rows, Weighting

By = tuple[Hypothesis, Floats] | None

#: Arguments of the regressor, but for a drift of friction and a gain, which only scale it.
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


class CachedTransform:
    """A motion under the first hypotheses of a model.

    Parameters
    ----------
    sought : BaseColumns
    weighting : Weighting
    hypothetical : HypotheticalMotion
        The motion as it is under them.
    before : CachedTransform, optional
        The same without the last of them.
    by : (Hypothesis, (n_psi,)), optional
        The last of them, with its psi.
    """

    def __init__(
        self,
        sought: BaseColumns,
        weighting: Weighting,
        hypothetical: HypotheticalMotion,
        before: "CachedTransform | None" = None,
        by: By = None,
    ) -> None:
        self._sought, self._weighting, self.hypothetical, self._before, self.by = (
            sought,
            weighting,
            hypothetical,
            before,
            by,
        )
        self._base_at: dict[int, Columns] = {}
        self._columns_at: dict[int, tuple[Columns, ...]] = {}
        self.last_torque: _LastTorque = before.last_torque if before is not None else _LastTorque()

    def then(self, hypothesis: Hypothesis, psi: Floats) -> "CachedTransform":
        """Return the motion under one hypothesis more."""
        by = hypothesis, np.array(psi)
        return CachedTransform(self._sought, self._weighting, hypothesis.act(self.hypothetical, psi), self, by)

    @cached_property
    def base(self) -> Columns:
        """The base regressor's rows."""
        before, hypothetical = self._before, self.hypothetical
        if before is not None and self._is_same(*_MOVES, "drift", "factor"):
            return before.base
        if before is not None and self._is_same(*_MOVES, "drift"):
            return before.base.plus((more, before.base_at(joint)) for joint, more in self._scaled(before))
        if before is not None and self._is_same(*_MOVES, "factor"):
            grown = self._grown(before)
            return before.base.plus(((hypothetical.factor[joint] * more, rows) for joint, more, rows in grown))
        return self._white(hypothetical.base(self._sought.of(hypothetical.arm)))

    def base_at(self, joint: int) -> Columns:
        """Return what one joint's own equation makes of these rows, by itself, for a gain of 1."""
        before, hypothetical = self._before, self.hypothetical
        if before is not None and self._is_same(*_MOVES, "drift"):
            return before.base_at(joint)
        if joint not in self._base_at:
            if before is not None and self._is_same(*_MOVES):
                grown = ((more, rows) for one, more, rows in self._grown(before) if one == joint)
                self._base_at[joint] = before.base_at(joint).plus(grown)
            else:
                alone = replace(
                    hypothetical, factor=(np.arange(hypothetical.q.shape[1]) == joint).astype(np.float64)
                )
                self._base_at[joint] = self._white(alone.base(self._sought.of(hypothetical.arm)))
        return self._base_at[joint]

    def _scaled(self, before: "CachedTransform") -> list[tuple[int, float]]:
        """Return joints that have another gain than before, and what their equations count more for that."""
        more = self.hypothetical.factor - before.hypothetical.factor
        return [(int(joint), float(more[joint])) for joint in np.flatnonzero(more)]

    def _grown(self, before: "CachedTransform") -> Iterator[tuple[int, float, Columns]]:
        """Yield joints whose friction drifts more, by how much, and what that makes of the base."""
        for joint, more in enumerate(self.hypothetical.drift - before.hypothetical.drift):
            if more:
                yield joint, float(more), before.growing[joint]

    @cached_property
    def growing(self) -> list[Columns]:
        """What each joint's friction is in the base, times the run's time, for a gain of 1, and nothing else."""
        hypothetical, n = self.hypothetical, self.hypothetical.q.shape[1]
        kept = self._sought.of(hypothetical.arm)
        plain = replace(hypothetical, drift=np.zeros(n), factor=np.ones(n))
        rows = plain.base(kept) * np.maximum(hypothetical.motion.t, 0.0)[:, None, None]
        is_its = ((kept == 10 * n + j) | (kept == 11 * n + j) for j in range(n))
        return [self._white(rows * its) for its in is_its]

    @cached_property
    def columns(self) -> tuple[Columns, ...]:
        """All further columns' rows."""
        before, now = self._before, self.hypothetical
        if before is None:
            return ()
        first, factor = len(before.hypothetical.columns), now.factor
        if factor is not before.hypothetical.factor and first:
            at = [(more, before.columns_at(joint)) for joint, more in self._scaled(before)]
            return tuple(one.plus((more, rows[k]) for more, rows in at) for k, one in enumerate(before.columns))
        added = (self._white(one * factor[:, None]) for one in now.columns[first:])
        return (*before.columns, *added)

    def columns_at(self, joint: int) -> tuple[Columns, ...]:
        """Return what one joint's own equation makes of these, by itself, for a gain of 1."""
        before, now = self._before, self.hypothetical
        if before is None:
            return ()
        if joint not in self._columns_at:
            alone = (np.arange(now.q.shape[1]) == joint)[:, None]
            new = now.columns[len(before.hypothetical.columns) :]
            added = (self._white(one * alone) for one in new)
            self._columns_at[joint] = (*before.columns_at(joint), *added)
        return self._columns_at[joint]

    @cached_property
    def rows(self) -> Rows:
        """The motion's equations."""
        return Rows(self.all_columns, self.right, self.hypothetical.q.shape[1])

    @cached_property
    def all_columns(self) -> Columns:
        """Base and further columns side by side."""
        before = self._before
        if before is not None and self._goes_on_from(before):
            new = self.columns[len(before.columns) :]
            return before.all_columns.hstacked(*new) if new else before.all_columns
        return self.base.hstacked(*self.columns) if self.columns else self.base

    @cached_property
    def right(self) -> Columns:
        """The right-hand side."""
        before, known = self._before, self._sought.known
        if before is not None and self._is_same("u", *(() if known is None else (*_MOVES, "factor"))):
            return before.right
        if known is not None:
            return self._white(self.hypothetical.target(known)[:, :, None])
        u = self.hypothetical.u
        return self.last_torque.rows(u, lambda: self._white(u[:, :, None]))

    def _white(self, rows: Floats) -> Columns:
        white = self._weighting.whitened(self.hypothetical.motion, rows)
        return Columns(self._weighting, self.hypothetical.motion, white.reshape(-1, white.shape[2]))

    def _goes_on_from(self, before: "CachedTransform") -> bool:
        """Say whether the rows are those before and maybe some more."""
        return self.base is before.base and all(a is b for a, b in zip(before.columns, self.columns, strict=False))

    def _is_same(self, *names: str) -> bool:
        """Say whether the last hypothesis has left some of the view as it was."""
        now, was = self.hypothetical, self._before.hypothetical if self._before is not None else None
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
        A standard parameter that is not sought: where no torque determines the scale of all the others, it does.
    given : Model
        What acts in addition to every model, without columns, unless the model has another in its stead.
    """

    def __init__(
        self,
        arm: Arm,
        weighting: Weighting,
        denied: tuple[str, ...] = (),
        known: tuple[int, float] | None = None,
        given: Model = BARE,
    ) -> None:
        self.arm, self.weighting, self.denied, self.known, self.given = arm, weighting, denied, known, given
        self._sought = BaseColumns(arm, denied, known)
        self._stages: dict[int, list[CachedTransform]] = {}

    def independent(self, arm: Arm) -> NDArray[np.intp]:
        """Return the columns of the standard regressor that stand for an arm's base parameters."""
        return self._sought.of(arm)

    def hypothetical(self, model: Model, motion: Motion) -> HypotheticalMotion:
        """Return a motion under a model, with the columns in the model's order."""
        return self._stage(model, motion).hypothetical

    def rows(self, model: Model, motion: Motion) -> Rows:
        """Return a motion's equations under a model, with the columns in the model's order."""
        return self._stage(model, motion).rows

    def design_at(self, model: Model, motion: Motion, joint: int) -> Floats:
        """Return what a joint's own equation makes of the design, by itself, for a gain of 1, shaped like it."""
        stage = self._stage(model, motion)
        return stage.base_at(joint).hstacked(*stage.columns_at(joint)).freed

    def residual_torque(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return the torque that factors leave, as it is on the motion's own grid, (n_sample, n_joint)."""
        hypothetical = self.hypothetical(model, motion)
        return hypothetical.target(self.known) - hypothetical.equations(self.independent(hypothetical.arm)) @ x

    def friction(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return the joints' viscous and Coulomb friction by a model's factors, (n_joint, 2)."""
        n = self.arm.n_joint
        kept = self.independent(self.hypothetical(model, motion).arm)
        standard = standard_parameters(self.arm)
        standard[kept] = x[: len(kept)]
        return np.stack([standard[10 * n : 11 * n], standard[11 * n :]], axis=1)

    def slopes(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return minus the Jacobian of the residual torque by factors and psi, unfiltered.

        Returns
        -------
        (n_sample, n_joint, n_factor + n_psi)
        """
        hypothetical = self.hypothetical(model, motion)
        columns = [hypothetical.equations(self.independent(hypothetical.arm))]
        for *neighbours, step in model.central_differences():
            more, less = (self.residual_torque(one, x, motion) for one in neighbours)
            columns.append((less - more)[..., None] / step)
        return np.concatenate(columns, axis=2)

    def _stage(self, model: Model, motion: Motion) -> CachedTransform:
        stages = self._stages.get(id(motion))
        if stages is None or stages[0].hypothetical.motion is not motion:  # another may have got its id
            stages = self._stages[id(motion)] = [
                CachedTransform(self._sought, self.weighting, as_measured(motion, self.arm))
            ]
        given = self.given.beside(model)
        whole = Model((*given.hypotheses, *model.hypotheses), (*given.psi, *model.psi))
        for k, i in enumerate(whole.downstream(), start=1):
            hypothesis, psi = whole.hypotheses[i], whole.psi[i]
            by = stages[k].by if k < len(stages) else None
            if by is None or by[0] is not hypothesis or not np.array_equal(by[1], psi):
                del stages[k:]
                stages.append(stages[-1].then(hypothesis, psi))
        return stages[len(whole.hypotheses)]
