"""A motion's equations under a model; what two models in a row have in common is computed once.

A model's hypotheses act one after the other, from the drive to the link, in whatever order they were found:
friction by load is that of the torque that arrives. Those that no other one acts on come first or last. So what a
search holds while it tries another one further down leaves the motion as it was: every stage keeps what follows.
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
#: What no torque enters, and then what acts on the torque before columns are made of it, in this order; the rest
#: follows. A limit is the same before a delay and after it, but before it the torque is as sharp as asked for.
_UPSTREAM = (
    *("backlash", "gravity_tilt", "joint_zero", "thermal_drift"),
    *("gain_error", "torque_saturation", "actuator_delay", "actuator_lag"),
)
#: What depends on how large the torque is that arrives. Beside nothing of these a gain comes last.
_FEEL_TORQUE = ("torque_saturation", "joint_elasticity", "load_friction")
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
        """What each joint's own equation makes of these rows, by itself, for a gain of 1: joints first."""
        if self._before is not None and self._is_same(*_MOVES):
            return self._before.base_by_joint
        rows = replace(self.view, factor=np.ones(self.view.q.shape[1])).base(self._of.independent(self.view.arm))
        return self._by_joint(rows)

    @cached_property
    def columns(self) -> tuple[Floats, ...]:
        """All further columns' rows."""
        before, now = self._before, self.view
        if before is None:
            return ()
        first, factor = len(before.view.columns), now.factor
        if factor is not before.view.factor and first:
            return tuple(np.tensordot(factor, one, 1) for one in before.columns_by_joint)
        filtered = self._of.weighting.filtered
        added = (filtered(now.motion, one * factor[:, None]) for one in now.columns[first:])
        return (*before.columns, *added)

    @cached_property
    def columns_by_joint(self) -> tuple[Floats, ...]:
        """What each joint's own equation makes of these, by itself, for a gain of 1: joints first."""
        if self._before is None:
            return ()
        added = (self._by_joint(one) for one in self.view.columns[len(self._before.view.columns) :])
        return (*self._before.columns_by_joint, *added)

    def _by_joint(self, rows: Floats) -> Floats:
        motion, alone = self.view.motion, np.eye(rows.shape[1])[:, :, None]
        return np.stack([self._of.weighting.filtered(motion, rows * one) for one in alone])

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
        return self._stage(model, motion).view

    def rows(self, model: Model, motion: Motion) -> Rows:
        """Return a motion's equations under a model, with the columns in the model's order."""
        stage = self._stage(model, motion)
        return Rows(stage.design, stage.target)

    def design_at(self, model: Model, motion: Motion, joint: int) -> Floats:
        """Return what a joint's own equation makes of the design, by itself, for a gain of 1, shaped like it."""
        stage = self._stage(model, motion)
        both = np.concatenate([one[joint] for one in (stage.base_by_joint, *stage.columns_by_joint)], axis=2)
        return both.reshape(-1, both.shape[2])

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


def scales_only(model: Model) -> bool:
    """Say whether a gain in a model does no more than scale what its joint resists with: nothing feels it."""
    return not any(hypothesis.kind.name in _FEEL_TORQUE for hypothesis in model.hypotheses)


def _downstream(model: Model) -> list[int]:
    """Return the places of a model's hypotheses in the order in which they act; of those with columns it stays."""
    gain_last = scales_only(model)

    def turn(k: int) -> int:
        hypothesis = model.hypotheses[k]
        if hypothesis.kind.name == "gain_error" and gain_last:
            return len(_UPSTREAM) + 2
        if hypothesis.n_column:
            return len(_UPSTREAM) + 1
        return _UPSTREAM.index(hypothesis.kind.name) if hypothesis.kind.name in _UPSTREAM else len(_UPSTREAM)

    return sorted(range(len(model.hypotheses)), key=turn)
