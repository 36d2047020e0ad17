"""The paper's way on a person: ratios under law (5) with a free equilibrium trajectory, and what they are worth.

The trajectory's bandwidth is learnt: from half of the motion's corner down it is lowered as long as masses and
stiffnesses leave no more of what it does not reach than the angles' noise (a chi-squared test). A bandwidth half
an octave above the lowest that passes is used.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.regressor import regressor
from arm.structural_parameters import structural_parameters
from fitter.controller.free_equilibrium import EquilibriumColumns, TrialEquations
from fitter.controller.homogeneous_fit import HomogeneousFit, homogeneous_fit
from fitter.data.trial import Trial
from limbcal.errors import NotIdentifiable

#: Bandwidths are half an octave apart.
_STEP = 2.0**0.5
#: Probability with which a bandwidth that suffices is refused.
_FALSE = 0.05
#: Splines a trial at the least: a line and its ends.
_SLOWEST_PERIODS = 1.0
#: Step of an angle for the slope of gravity's torque [rad].
_SLOPE_RAD = 1e-5


@dataclass(frozen=True)
class EquilibriumRatio:
    """A ratio to the last inertia; without an interval where the motion does not tell it."""

    name: str
    unit: str
    value: float
    ci95: tuple[float, float] | None

    def document(self) -> dict[str, object]:
        """Return it as it stands in a JSON document."""
        known = self.ci95 is not None
        interval = None if self.ci95 is None else list(self.ci95)
        return {"name": self.name, "unit": self.unit, "value": self.value if known else None, "ci95": interval}


@dataclass(frozen=True)
class EquilibriumFit:
    """What a motion tells under law (5) if its equilibrium trajectory is slow.

    Attributes
    ----------
    ratios : tuple of EquilibriumRatio
        Empty where no trajectory that is slower than the motion explains it.
    bandwidth_hz : float, optional
        Of the trajectory.
    corner_hz : float
        Up to which the equations are used.
    """

    ratios: tuple[EquilibriumRatio, ...]
    bandwidth_hz: float | None
    corner_hz: float

    @property
    def known(self) -> tuple[EquilibriumRatio, ...]:
        """Those that have an interval."""
        return tuple(one for one in self.ratios if one.ci95 is not None)

    def document(self) -> dict[str, object]:
        """Return it as it stands in a JSON document."""
        return {
            "up_to_scale": True,
            "ratios": [one.document() for one in self.ratios],
            "equilibrium_bandwidth_hz": self.bandwidth_hz,
            "corner_hz": self.corner_hz,
            "sentences": list(self.sentences()),
        }

    def sentences(self) -> tuple[str, ...]:
        """Say what the ratios rest on, and what they are worth."""
        if self.bandwidth_hz is None:
            return (
                f"up to scale: law (5) with an equilibrium trajectory slower than {0.5 * self.corner_hz:.2g} Hz "
                "leaves more of the motion than the angles' noise; so the trajectory is free, and a free one "
                "makes any motion with any masses: no ratio is known",
            )
        rests = (
            f"up to scale: law (5) and an equilibrium trajectory slower than {self.bandwidth_hz:.2g} Hz are "
            "assumed, nobody measured either; kilograms stay unknown"
        )
        if not self.known:
            return (
                rests,
                "this motion tells no ratio: such a trajectory makes it as well with any masses; expected "
                "a motion that the trajectory cannot follow, such as a quick release from a load or taps",
            )
        return rests, f"{len(self.known)} of {len(self.ratios)} ratios are known; intervals hold if both are true"


def equilibrium_ratios(arm: Arm, trials: Sequence[Trial], seed: int = 0) -> EquilibriumFit:
    """Return what motions tell of an arm under law (5) with a free equilibrium trajectory.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity; frame 0 stands.
    trials : sequence of Trial
    seed : int
        Of the noise that is drawn.

    Raises
    ------
    NotIdentifiable
        If no joint turns, or trials are too short.
    """
    base = structural_parameters(arm)
    columns, rng = equilibrium_columns(arm, base), np.random.default_rng(seed)
    equations = [TrialEquations(arm, base, columns, trial, rng) for trial in trials]
    corner, seconds = min(one.corner_hz for one in equations), min(one.seconds for one in equations)
    n_tried = int(np.floor(np.log(0.5 * corner * seconds / _SLOWEST_PERIODS) / np.log(_STEP))) + 1
    if n_tried < 1:
        raise NotIdentifiable(
            f"trials last {seconds:.3g} s with a corner of {corner:.3g} Hz; expected some periods of the motion"
        )
    tried = 0.5 * corner / _STEP ** np.arange(n_tried)
    fits = list[HomogeneousFit]()
    for bandwidth in tried:
        fit = _fit(equations, float(bandwidth), arm.n_joint)
        if fit.sigma**2 * fit.dof > scipy.stats.chi2.isf(_FALSE / n_tried, fit.dof):
            break
        fits.append(fit)
    if not fits:
        return EquilibriumFit((), None, corner)
    place = max(len(fits) - 2, 0)
    stiffness = _gravity_slopes(arm, base, trials)[:, [k for k in columns.kept if k < len(base.names)]]
    return EquilibriumFit(tuple(_ratios(arm, columns, fits[place], stiffness)), float(tried[place]), corner)


def equilibrium_columns(arm: Arm, base: BaseParameters) -> EquilibriumColumns:
    """Return the unknowns of an arm under law (5).

    Raises
    ------
    NotIdentifiable
        If no joint turns.
    """
    inertial = [k for k, column in enumerate(base.independent) if column < 10 * arm.n_joint and column % 10 < 6]
    if not inertial:
        raise NotIdentifiable(f"arm {arm.name}: no joint turns, so there is no inertia to take ratios to")
    numbers = range(1, arm.n_joint + 1)
    dry, damping = {f"fc{j}" for j in numbers}, {f"D{j}": f"D{j}-kv{j}" for j in numbers}
    kept = [k for k, name in enumerate(base.names) if name not in dry]
    stiff = ["N m/rad" if joint.type == "revolute" else "N/m" for joint in arm.joints]
    return EquilibriumColumns(
        (*(damping.get(base.names[k], base.names[k]) for k in kept), *(f"kp{j}" for j in numbers)),
        (*(base.units[k] for k in kept), *stiff),
        (*kept, *(len(base.names) + j - 1 for j in numbers)),
        kept.index(inertial[-1]),
    )


def _fit(equations: Sequence[TrialEquations], bandwidth_hz: float, n_joint: int) -> HomogeneousFit:
    """Fit all trials; noise is as if all joints had the same, so that no equation is counted twice."""
    rows, noise = zip(*(one.beyond(bandwidth_hz) for one in equations), strict=True)
    return homogeneous_fit(rows, noise, float(n_joint))


def _ratios(arm: Arm, columns: EquilibriumColumns, fit: HomogeneousFit, gravity: Floats) -> list[EquilibriumRatio]:
    unit, n = np.eye(len(columns.names)), arm.n_joint
    under, scale = columns.names[columns.reference], columns.units[columns.reference]
    functions = {name: (unit[k], columns.units[k]) for k, name in enumerate(columns.names) if name != under}
    for j in range(n):
        both = unit[len(columns.names) - n + j].copy()
        both[: gravity.shape[1]] += gravity[j]
        functions[f"kp{j + 1} and gravity"] = both, columns.units[len(columns.names) - n + j]
    found = []
    for name, (over, its_unit) in functions.items():
        value, interval = fit.ratio(over, unit[columns.reference])
        found.append(EquilibriumRatio(f"({name})/{under}", f"{its_unit} / ({scale})", value, interval))
    return found


def _gravity_slopes(arm: Arm, base: BaseParameters, trials: Sequence[Trial]) -> Floats:
    """Return how gravity's torque in each joint turns with its angle at the mean posture, (n_joint, n_base)."""
    q = np.mean([trial.q.mean(axis=0) for trial in trials], axis=0)
    step, still = _SLOPE_RAD * np.eye(arm.n_joint), np.zeros((arm.n_joint, arm.n_joint))
    ahead, behind = (regressor(arm, q + s, still, still)[..., base.independent] for s in (step, -step))
    own = np.arange(arm.n_joint)
    return np.asarray((ahead - behind)[own, own] / (2.0 * _SLOPE_RAD))
