r"""What a free swing tells of an arm: ratios to its last inertia, with elastic joints and without.

Nothing drives a joint that swings freely, so the torque equation is homogeneous in the base parameters ``b``:

.. math:: Y(q, \dot q, \ddot q)\, b + K (q - q_0) = 0

and only ratios are identifiable. Gravity and the elasticity ``K`` of what hangs between two links (skin, a cable,
muscles that are not tensed) both draw a joint to some angle; where swings are small they are the same. A ratio is
known as well as its interval with springs says, whatever its interval without them is. Where a swing comes to the
end of a joint's range, tissue that stiffens there (`fitter.dynamics.range_ends`) is allowed for as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm
from arm.regressor import standard_parameters
from arm.structural_parameters import structural_parameters
from fitter.data.standstill import REST_SPEED
from fitter.data.trial import Trial
from fitter.dynamics.range_ends import Fit, RangeEnd, end_columns, stiff_ends
from fitter.dynamics.torque_problem import torque_problem
from fitter.regression_sums.torque_sums import TorqueSums, add_up, row_sums
from fitter.regression_sums.trial_sums import filtered_rows, moving_all_along
from fitter.search.fitted_parameter import FittedParameter
from limbcal.errors import NotIdentifiable

#: Dry friction changes its sign with the velocity, so it has the odd harmonics of a swing, the third before all. A
#: corner where the swing's own spectrum meets the noise leaves none of them.
_HARMONIC = 3.0
#: A corner is at most this ratio of the sampling rate: Nyquist's frequency less what a filter needs to fall.
_HIGHEST = 0.4


@dataclass(frozen=True)
class SwingRatio:
    """A base parameter over the last inertia.

    Attributes
    ----------
    name : str
        Of the ratio.
    rigid, sprung : FittedParameter
        Without springs and with them.
    stiffening : FittedParameter, optional
        With springs and with tissue that stiffens towards the ends of ranges; None where no swing shows any.
    is_spring : bool
        Whether it is a spring's stiffness.
    """

    name: str
    rigid: FittedParameter
    sprung: FittedParameter
    stiffening: FittedParameter | None
    is_spring: bool

    @property
    def honest(self) -> FittedParameter:
        """What a swing knows of it: with all that is elastic."""
        return self.sprung if self.stiffening is None else self.stiffening

    @property
    def is_significant(self) -> bool:
        """Whether zero is outside its interval with all that is elastic."""
        return abs(self.honest.value) > self.honest.half_width

    def document(self) -> dict[str, object]:
        """Return the ratio as it stands in a JSON document, with intervals of 95 %."""
        fields: dict[str, object] = {"name": self.name, "unit": self.sprung.unit}
        each = {"without_springs": self.rigid, "with_springs": self.sprung, "with_tissue": self.stiffening}
        for which, one in each.items():
            known = None if one is None or one.ci95 is None else {"value": one.value, "ci95": list(one.ci95)}
            fields[which] = known
        return fields


@dataclass(frozen=True)
class FreeSwing:
    """What a free swing tells.

    Attributes
    ----------
    ratios : tuple of SwingRatio
    ends : tuple of RangeEnd
        Where tissue stiffens; how much is not stated, for noise in the angle shifts it.
    """

    ratios: tuple[SwingRatio, ...]
    ends: tuple[RangeEnd, ...]

    def document(self) -> dict[str, object]:
        """Return it as it stands in a JSON document."""
        ends = [{"joint": end.joint + 1, "angle_rad": end.angle_rad, "side": end.side} for end in self.ends]
        return {"ratios": [ratio.document() for ratio in self.ratios], "stiff_ends": ends}


def last_inertia(base: BaseParameters, n_joint: int) -> int | None:
    """Return which base parameter is the last link's inertia about its axis; None if no joint turns."""
    inertial = [k for k, column in enumerate(base.independent) if column < 10 * n_joint and column % 10 < 6]
    return inertial[-1] if inertial else None


def swing_scale(arm: Arm) -> dict[str, float]:
    """Return the last inertia and its value in the arm file, or 1 if there is none: all else is in its unit.

    Raises
    ------
    NotIdentifiable
        If no joint turns.
    """
    base = structural_parameters(arm)
    reference = _reference(arm, base)
    value = float((base.combination @ standard_parameters(arm))[reference])
    return {base.names[reference]: value if value > 0.0 else 1.0}


def swing_corner_hz(trials: Sequence[Trial]) -> float:
    """Return the corner [Hz] at which swings show dry friction, by the one that they came with.

    Noise in accelerations that it lets through is in the known side of the equation, where it shifts no ratio.
    """
    return min(min(_HARMONIC * trial.cutoff_hz, _HIGHEST / trial.dt_s) for trial in trials)


def swing_ratios(arm: Arm, trials: Sequence[Trial]) -> FreeSwing:
    """Return the ratios of an arm's base parameters to its last inertia, stiffnesses of springs among them.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity.
    trials : sequence of Trial
        Nothing drives the arm in them.

    Raises
    ------
    NotIdentifiable
        If no joint turns, or none moves.
    """
    base, n = structural_parameters(arm), arm.n_joint
    reference = _reference(arm, base)

    def fit(springs: bool, ends: Sequence[RangeEnd] = (), order: int = 0) -> Fit:
        sums = add_up([_sums(arm, base, trial, springs, ends, order) for trial in trials])
        problem = torque_problem(sums, np.zeros(sums.gram.shape[-1]), {reference: 1.0})
        values = problem.complete(problem.optimum())
        return Fit(values, problem.standard_errors(values), problem.rest)

    n_sprung = len(base.names) + 2 * n
    ends = stiff_ends(arm, trials, lambda some: fit(springs=True, ends=some).after(n_sprung))
    fits = [fit(springs=False), fit(springs=True), *([fit(springs=True, ends=ends, order=1)] if ends else [])]
    names = [*base.names, *(f"K{j + 1}" for j in range(n))]
    units = [*base.units, *("N m/rad" if joint.type == "revolute" else "N/m" for joint in arm.joints)]

    def ratio(k: int) -> SwingRatio:
        unit = f"{units[k]} / ({base.units[reference]})"
        rigid, sprung, *stiffening = (one.parameter(k, unit) for one in fits)
        is_spring = k >= len(base.names)
        name = f"({names[k]})/{base.names[reference]}"
        return SwingRatio(name, rigid, sprung, stiffening[0] if stiffening else None, is_spring)

    return FreeSwing(tuple(ratio(k) for k in range(len(names)) if k != reference), tuple(ends))


def _reference(arm: Arm, base: BaseParameters) -> int:
    reference = last_inertia(base, arm.n_joint)
    if reference is None:
        raise NotIdentifiable(f"arm {arm.name}: no joint turns, so there is no inertia to take ratios to")
    return reference


def _sums(
    arm: Arm, base: BaseParameters, trial: Trial, springs: bool, ends: Sequence[RangeEnd], order: int
) -> TorqueSums:
    """Return the sums of a trial's equations; a spring adds the columns of its stiffness and of its rest."""
    everything = slice(0, len(trial.q))
    rows = filtered_rows(arm, base, trial, everything)
    if springs:
        n = arm.n_joint
        angles, ones = np.zeros((2, len(rows), n, n))
        joints = np.arange(n)
        angles[:, joints, joints] = trial.lowpass(trial.q)
        ones[:, joints, joints] = -1.0
        rows = np.concatenate([rows, angles, ones], axis=2)
    if ends:
        rows = np.concatenate([rows, trial.lowpass(end_columns(ends, trial.q, order))], axis=2)
    return row_sums(rows, np.zeros_like(trial.q), moving_all_along(trial, everything, REST_SPEED))
