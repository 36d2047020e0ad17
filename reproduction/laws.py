"""Tables 4 and 5: what becomes of the dynamics when gains or the law itself are not those that are assumed.

Three things can be meant by "we calibrated with other gains", and they come out as differently as can be. A: the
arm was driven with them, and they are known. B: it was driven with 9.5 / -9.5 and the others are merely assumed.
C: nobody knows them, but for one number.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.base_parameters import base_parameters, with_base_values
from arm.bench import Bench
from arm.model import Arm, Law
from arm.regressor import standard_parameters
from fitter.controller.controller import ControllerFit, fit_controller
from fitter.controller.instrumental_variables import InstrumentalVariables
from fitter.controller.law_columns import law_columns
from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.evaluation import motion_error
from fitter.dynamics.fit import fit_dynamics
from fitter.report.published import PARAMETERS, TRUE
from fitter.search.fitted_parameter import FittedParameter
from reproduction.bench_data import bench_trials, noisy_trials, under
from reproduction.experiment import Cell, Grid
from reproduction.parameter_rows import INERTIAL, fitted_row, interval, numbers, plain_row

#: Table 6 has the same figures for 300 000 data as Table 4 has in its first row.
SAMPLES, QUICK_SAMPLES = 300_000, 5_400
QUICK_BENCH = Bench(learning=2, evaluating=1)
#: The gains that section 8.1 says the arm stood under.
TRUE_KP, TRUE_KV = 9.5, -9.5
#: In C angles have this much noise, as a share of their own spread; A and B are without any.
NOISE = 0.01
#: What is known in C, and in whose unit everything else comes out.
KNOWN = "I2"
#: Rate at which evaluating motions are simulated and compared [Hz]; targets change on its grid.
_RATE_HZ = 400.0
POPULATION = 100
#: Poses of each motion at which the inertia is looked at.
_POSES = 50
#: Gains of the arm file in C: no one's.
_FILE_KP, _FILE_KV, _FILE_KA = 1.0, -1.0, -1.0


@dataclass(frozen=True)
class Gains:
    """A row of Table 4 or 5: a law with the same gains in both joints, and what the paper prints."""

    law: Law
    kp: float
    kv: float | None
    ka: float | None
    paper: tuple[float, ...]

    @property
    def labels(self) -> tuple[str, str, str]:
        """The gains as cells."""
        return tuple("–" if gain is None else f"{gain:g}" for gain in (self.kp, self.kv, self.ka))  # type: ignore[return-value]

    def drive(self, arm: Arm) -> Arm:
        """Return the arm under these gains."""
        return under(arm, self.law, self.kp, self.kv, self.ka)


@dataclass(frozen=True)
class AngleError:
    """Simulated against true angles of the evaluating motions, mean and largest [deg]; infinite if it ran away."""

    mean: float
    worst: float

    def cells(self) -> tuple[str, str]:
        """Return mean and largest error as cells."""
        return ("ran away", "ran away") if np.isinf(self.worst) else (f"{self.mean:.3g}", f"{self.worst:.3g}")

    def document(self) -> dict[str, float | None]:
        """Return both for JSON; None where the simulation ran away."""
        return {
            "mean": self.mean if np.isfinite(self.mean) else None,
            "max": self.worst if np.isfinite(self.worst) else None,
        }


@dataclass(frozen=True)
class Row:
    """What came of one row: fits A, B, C, and errors of simulated angles by name."""

    gains: Gains
    driven: DynamicsFit
    assumed: DynamicsFit
    unknown: ControllerFit
    errors: Mapping[str, AngleError]


PAPER = "the paper's row, driven with these"
PAPER_INERTIAL = "the paper's inertial parameters with the true friction, driven with these"
CASE_A = "A: driven with these"
CASE_B = "B: driven with 9.5 / -9.5, simulated under these"
CASE_B_TRUE = "B: driven with 9.5 / -9.5, simulated under 9.5 / -9.5"
CASE_C = "C: driven with these, gains unknown"


@dataclass(frozen=True)
class Benches:
    """Motions under the arm's own gains: learning and evaluating."""

    learn: Sequence[Trial]
    evaluate: Sequence[Trial]


def benches(arm: Arm, samples: int, seed: int, size: Bench) -> Benches:
    """Return learning and evaluating motions of an arm under its law.

    Parameters
    ----------
    arm : Arm
    samples : int
        Of the learning motions together.
    seed : int
    size : Bench
        How many motions.
    """
    rough = round(size.learning * _RATE_HZ * size.trial_s)
    coarse = bench_trials(arm, rough, seed, size.learning, size.evaluating)
    return Benches(
        bench_trials(arm, samples, seed, size.learning), [trial for trial in coarse if trial.role == "evaluate"]
    )


def row(arm: Arm, own: Benches, gains: Gains, samples: int, seed: int, size: Bench) -> Row:
    """Work one row out, all three ways.

    Parameters
    ----------
    arm : Arm
        The true one.
    own : Benches
        Its motions under 9.5 / -9.5.
    gains : Gains
    samples : int
    seed : int
    size : Bench
    """
    truly = gains.drive(arm)
    there = benches(truly, samples, seed, size)
    driven = fit_dynamics(truly, there.learn, objective="torque", seed=seed, population=POPULATION)
    assumed = fit_dynamics(truly, own.learn, objective="torque", seed=seed, population=POPULATION)
    kv, ka = (None if gain is None else value for gain, value in ((gains.kv, _FILE_KV), (gains.ka, _FILE_KA)))
    file = under(arm, gains.law, _FILE_KP, kv, ka)
    known = dict(zip(PARAMETERS, TRUE, strict=True))[KNOWN]
    unknown = fit_controller(file, noisy_trials(there.learn, NOISE, seed), fixed={KNOWN: known})
    base = base_parameters(arm)
    inertial = len(INERTIAL)
    paper, half_true = (
        with_base_values(truly, base, np.array([*gains.paper[:k], *TRUE[k:]])) for k in (len(TRUE), inertial)
    )
    as_it_was = under(assumed.arm, "pd", TRUE_KP, TRUE_KV)
    errors = {
        PAPER: angle_error(paper, there.evaluate),
        PAPER_INERTIAL: angle_error(half_true, there.evaluate),
        CASE_A: angle_error(driven.arm, there.evaluate),
        CASE_B: angle_error(assumed.arm, own.evaluate),
        CASE_B_TRUE: angle_error(as_it_was, own.evaluate),
        CASE_C: angle_error(unknown.arm, there.evaluate),
    }
    return Row(gains, driven, assumed, unknown, errors)


def angle_error(arm: Arm, trials: Sequence[Trial]) -> AngleError:
    """Return how far an arm's simulation is from some motions.

    Infinitely far, if its inertia under its law isn't positive: no simulation of it means anything.
    """
    base = base_parameters(arm)
    columns = law_columns(arm, base, arm.control.law)
    values = columns.start(base.combination @ standard_parameters(arm), arm.control)
    somewhere = np.concatenate([trial.q[:: max(1, len(trial.q) // _POSES)] for trial in trials])
    if not InstrumentalVariables(arm, base, columns).possible(values, somewhere):
        return AngleError(np.inf, np.inf)
    with np.errstate(over="ignore", invalid="ignore"):  # an arm that no masses can have may run away
        off = np.rad2deg(np.abs(np.concatenate([motion_error(arm, trial) for trial in trials])))
    return AngleError(float(np.mean(off)), float(np.max(off)))


def parameter_grid(title: str, rows: Sequence[Row]) -> Grid:
    """Return the paper's columns for every row: the paper's own, A, B and C."""
    cells: list[tuple[Cell, ...]] = [plain_row(("true", "", "", ""), TRUE)]
    for r in rows:
        labels = r.gains.labels
        cells.append(plain_row((*labels, "paper"), r.gains.paper))
        cells.append(fitted_row((*labels, "A"), r.driven.parameters))
        cells.append(fitted_row((*labels, "B"), r.assumed.parameters))
        cells.append((*labels, "C", *(_found(r.unknown.parameters[name], name) for name in PARAMETERS)))
    return Grid(title, ("kp", "kv", "ka", "case", *PARAMETERS), tuple(cells))


def gain_grid(title: str, rows: Sequence[Row]) -> Grid:
    """Return the gains that were found in C, and what is only determined together."""
    cells: list[tuple[Cell, ...]] = []
    for r in rows:
        alone = ", ".join(f"{n} {interval(p)}" for n, p in r.unknown.gains.items() if p.identifiable)
        together = "; ".join(said.split(";")[0] for said in r.unknown.only_together)
        cells.append((*r.gains.labels, alone, together or "–", r.unknown.law_misfit.sentence))
    header = ("true kp", "true kv", "true ka", "gains found", "only together", "form of the law")
    return Grid(title, header, tuple(cells))


def error_grid(title: str, rows: Sequence[Row]) -> Grid:
    """Return errors of the simulated angles, case by case."""
    cells: list[tuple[Cell, ...]] = []
    for r in rows:
        cells += [(*r.gains.labels, case, *error.cells()) for case, error in r.errors.items()]
    return Grid(title, ("kp", "kv", "ka", "case", "mean [deg]", "max [deg]"), tuple(cells))


def document(rows: Sequence[Row]) -> list[dict[str, object]]:
    """Return the same figures for JSON."""
    return [
        {
            "law": r.gains.law,
            "kp": r.gains.kp,
            "kv": r.gains.kv,
            "ka": r.gains.ka,
            "paper": dict(zip(PARAMETERS, r.gains.paper, strict=True)),
            "A": numbers(r.driven.parameters),
            "B": numbers(r.assumed.parameters),
            "C": {
                **numbers(r.unknown.parameters),
                "gains": {name: p.document() for name, p in r.unknown.gains.items()},
                "only_together": list(r.unknown.only_together),
                "fixed_by": r.unknown.fixed_by,
                "law": r.unknown.law_misfit.sentence,
            },
            "angle_error_deg": {case: error.document() for case, error in r.errors.items()},
        }
        for r in rows
    ]


def inertial_ratios(values: Sequence[float]) -> list[float]:
    """Return inertial parameters over the true ones."""
    n = len(INERTIAL)
    return [value / true for value, true in zip(values[:n], TRUE[:n], strict=True)]


def nearer_to_truth(r: Row) -> bool:
    """Say whether the paper's inertial parameters are nearer to the true ones than to those of a wrong factor."""
    size = np.log(np.abs(inertial_ratios(r.gains.paper)))
    return bool(np.sum(size**2) < np.sum((size - np.log(r.gains.kp / TRUE_KP)) ** 2))


def fitted_values(parameters: Mapping[str, FittedParameter]) -> list[float]:
    """Return values in the order of the paper's columns."""
    return [parameters[name].value for name in PARAMETERS]


def _found(parameter: FittedParameter, name: str) -> str:
    return f"{parameter.value:.6f} (given)" if name == KNOWN else interval(parameter)
