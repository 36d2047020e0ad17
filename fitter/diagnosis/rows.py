"""A motion's equations under a model; what two models in a row have in common is computed once.

A model's hypotheses act one after the other, from the drive to the link, in whatever order they were found:
friction by load is that of the torque that arrives. So those that a search holds while it tries another one
further down leave the motion as it was: every stage keeps what follows from it.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.view import View, view_of
from fitter.dynamics.structure import structural_parameters

#: Slopes with respect to psi are taken over this share of its size.
SLOPE = 1e-4
#: What acts before columns are made of motion and torque, in this order. A limit is the same before a delay and
#: after it, but before it the torque is as sharp as it was asked for.
_UPSTREAM = ("gain_error", "torque_saturation", "actuator_delay", "actuator_lag")
#: What of a view the regressor is made of.
_MOVES = ("arm", "q", "dq", "ddq", "direction", "drift")
_MAKES_REGRESSOR = (*_MOVES, "factor")


@dataclass(frozen=True)
class Rows:
    """A motion's equations on the slower grid, ``design x = target``, noise white with variance 1.

    Attributes
    ----------
    design : (n_slower * n_joint, n_factor)
        The base parameters' columns, and then all others; the same array as long as nothing has changed in it.
    target : (n_slower, n_joint)
    """

    design: Floats
    target: Floats


class _Stage:
    """A motion under the first hypotheses of a model; ``by`` is the last of them, with its psi."""

    def __init__(
        self, of: "Equations", view: View, before: "_Stage | None", by: tuple[Hypothesis, Floats] | None
    ) -> None:
        self._of, self.view, self._before, self.by = of, view, before, by

    @cached_property
    def base(self) -> Floats:
        """The base regressor's rows."""
        before = self._before
        if before is not None and self._moves_as_before:
            return before.base
        if before is not None and self._is_same(*_MOVES):
            return np.asarray(np.tensordot(self.view.factor, before.base_by_joint, 1), dtype=np.float64)
        rows = self.view.base(self._of.independent(self.view.arm))
        return self._of.weighting.filtered(self.view.motion, rows)

    @cached_property
    def base_by_joint(self) -> Floats:
        """What each joint's own equation makes of these rows, by itself, for a factor of 1: joints first."""
        rows = replace(self.view, factor=np.ones(self.view.q.shape[1])).base(self._of.independent(self.view.arm))
        filtered_at = self._of.weighting.filtered_at
        parts = [filtered_at(self.view.motion, joint, rows[:, joint]) for joint in range(rows.shape[1])]
        return np.stack(parts).reshape(len(parts), -1, *rows.shape[1:])

    @cached_property
    def columns(self) -> tuple[Floats, ...]:
        """All further columns' rows."""
        if self._before is None:
            return ()
        first = len(self._before.view.columns)
        added = (self._of.weighting.filtered(self.view.motion, one) for one in self.view.columns[first:])
        return (*self._before.columns, *added)

    @cached_property
    def design(self) -> Floats:
        """Base and further columns side by side."""
        before = self._before
        if before is not None and self.base is before.base and len(self.columns) == len(before.columns):
            return before.design
        both = np.concatenate([self.base, *self.columns], axis=2)
        return np.asarray(both.reshape(-1, both.shape[2]), dtype=np.float64)

    @cached_property
    def target(self) -> Floats:
        """The right-hand side's rows."""
        before, known = self._before, self._of.known
        if before is not None and self.view.u is before.view.u and (known is None or self._moves_as_before):
            return before.target
        return self._of.weighting.filtered(self.view.motion, self.view.target(known))

    @property
    def _moves_as_before(self) -> bool:
        """Whether the last hypothesis has left all that the regressor is made of."""
        return self._is_same(*_MAKES_REGRESSOR)

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
        self._independent: dict[tuple[float, ...], NDArray[np.intp]] = {}
        self._stages: dict[int, list[_Stage]] = {}

    def independent(self, arm: Arm) -> NDArray[np.intp]:
        """Return the columns of the standard regressor that stand for an arm's base parameters."""
        key = (*np.sign(arm.gravity_m_s2), *(np.sign(np.subtract(arm.gravity_m_s2, self.arm.gravity_m_s2))))
        if key not in self._independent:
            x, y, z = (
                float(g if g == g0 else g0 + 0.7 + 0.1 * k)
                for k, (g, g0) in enumerate(zip(arm.gravity_m_s2, self.arm.gravity_m_s2, strict=True))
            )
            base = structural_parameters(replace(arm, gravity_m_s2=(x, y, z)))
            kept = [
                column
                for column, name in zip(base.independent, base.names, strict=True)
                if not any(name.rstrip("0123456789") == start for start in self.denied)
                and not (self.known is not None and column == self.known[0])
            ]
            self._independent[key] = np.array(kept)
        return self._independent[key]

    def view(self, model: Model, motion: Motion) -> View:
        """Return a motion under a model, with the columns in the model's order."""
        view = self._stage(model, motion).view
        order = _downstream(model)
        if order == sorted(order):
            return view
        at = [k for k in order if model.hypotheses[k].n_column]
        return replace(view, columns=tuple(view.columns[at.index(k)] for k in sorted(at)))

    def rows(self, model: Model, motion: Motion) -> Rows:
        """Return a motion's equations under a model, with the columns in the model's order."""
        stage, order = self._stage(model, motion), _downstream(model)
        if order == sorted(order):
            return Rows(stage.design, stage.target)
        widths = [model.hypotheses[k].n_column for k in order]
        ends = np.cumsum([stage.base.shape[2], *widths])
        placed = {k: np.arange(end - width, end) for k, width, end in zip(order, widths, ends[1:], strict=True)}
        columns = np.concatenate([np.arange(ends[0]), *(placed[k] for k in sorted(order))])
        return Rows(stage.design[:, columns], stage.target)

    def left(self, model: Model, x: Floats, motion: Motion) -> Floats:
        """Return the torque that factors leave, as it is on the motion's own grid, (n_sample, n_joint)."""
        view = self.view(model, motion)
        columns = np.concatenate([view.base(self.independent(view.arm)), *view.columns], axis=2)
        return view.target(self.known) - columns @ x

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
        columns = [view.base(self.independent(view.arm)), *view.columns]
        for *beside, apart in model.beside():
            more, less = (self.left(one, x, motion) for one in beside)
            columns.append((less - more)[..., None] / apart)
        return np.concatenate(columns, axis=2)

    def _stage(self, model: Model, motion: Motion) -> _Stage:
        stages = self._stages.get(id(motion))
        if stages is None or stages[0].view.motion is not motion:  # another may have got its id
            stages = self._stages[id(motion)] = [_Stage(self, view_of(motion, self.arm), None, None)]
        for k, i in enumerate(_downstream(model), start=1):
            hypothesis, psi = model.hypotheses[i], model.psi[i]
            by = stages[k].by if k < len(stages) else None
            if by is None or by[0] is not hypothesis or not np.array_equal(by[1], psi):
                del stages[k:]
                view = hypothesis.act(stages[-1].view, psi)
                stages.append(_Stage(self, view, stages[-1], (hypothesis, np.array(psi))))
        return stages[len(model.hypotheses)]


def _downstream(model: Model) -> list[int]:
    """Return the places of a model's hypotheses in the order in which they act."""

    def turn(k: int) -> int:
        hypothesis = model.hypotheses[k]
        if hypothesis.n_column:
            return len(_UPSTREAM) + 1
        name = hypothesis.kind.name
        return _UPSTREAM.index(name) if name in _UPSTREAM else len(_UPSTREAM)

    return sorted(range(len(model.hypotheses)), key=turn)
