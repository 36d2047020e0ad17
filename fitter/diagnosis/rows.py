"""A motion's equations under a model; what two models in a row have in common is computed once.

What a search holds while it tries a hypothesis that acts further down leaves the motion as it was: every stage
keeps what follows from it.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from fitter.diagnosis.base_columns import BaseColumns
from fitter.diagnosis.equation import Weighting
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.stage import Stage
from fitter.diagnosis.view import View, view_of
from fitter.diagnosis.white_rows import Rows

#: Slopes with respect to psi are taken over this share of its size.
SLOPE = 1e-4


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
