"""Table 3: the dynamics from joint angles with noise, their velocities and accelerations computed or exact."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm
from fitter.data.trial import Trial
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.fit import fit_dynamics
from fitter.dynamics.torque_search import GENERATIONS
from fitter.report.published import PARAMETERS, SAMPLES, TABLE3, TRUE
from limbcal.digits import NORMAL_95
from limbcal.note import documents
from reproduction.bench_data import angle_spread, bench_trials, noisy_trials, true_arm, true_values
from reproduction.cramer_rao import least_std
from reproduction.experiment import Cell, Experiment, Grid, Settings
from reproduction.parameter_rows import (
    INERTIAL,
    fitted_row,
    method_said,
    numbers,
    off_percent,
    outside,
    plain_row,
    worst_inertial_percent,
)

POPULATION = 100
_QUICK_SAMPLES = 5_000
#: Samples of the motions from which the least possible errors are computed.
_BOUND_SAMPLES = 16_875
_PLAIN_A = "A: plain, derivatives by differences"
_PLAIN_B = "B: plain, derivatives exact"
_FILTERED = "A: ours, torque behind a zero-phase filter"
_MOTION = "A: ours, simulated motion"


@dataclass(frozen=True)
class Row:
    """What came of one noise: fits by the name of the method, and the least standard errors there can be."""

    percent: int
    fits: Mapping[str, DynamicsFit]
    least: Mapping[str, float]


def run(settings: Settings) -> Experiment:
    """Repeat Table 3 both ways it can be read."""
    arm, true = true_arm(), dict(zip(PARAMETERS, TRUE, strict=True))
    samples = settings.samples or (_QUICK_SAMPLES if settings.quick else SAMPLES)
    trials, coarse = bench_trials(arm, samples, settings.seed), bench_trials(arm, _BOUND_SAMPLES, settings.seed)
    shares = list(TABLE3)[-1:] if settings.quick else list(TABLE3)
    rows = []
    for percent in shares:
        settings.progress(f"table3: {percent} % of noise in the angles")
        rows.append(_row(arm, trials, coarse, percent, settings.seed))
    spread = np.rad2deg(angle_spread(trials))
    return Experiment(
        name="table3",
        title="Table 3: dynamics from angles with noise",
        assumptions=(
            "What “error [%]” is a percentage of is not printed. Here it is the standard deviation of white "
            "Gaussian noise in every sample of every angle, as a share of that angle's rms about its mean "
            f"({', '.join(f'{x:.1f}°' for x in spread)}), so 10 % is about {spread.mean() / 10:.0f}°.",
            f"{sum(len(trial.t) for trial in trials)} samples of the five learning motions; targets and law (5) "
            "with its gains are known.",
            "Where velocities and accelerations come from is not printed either. A: they are computed from the "
            "noisy angles. B: the noise is on the angles alone, derivatives are exact; nobody can measure so, but "
            "the paper's figures change so little with the noise that it may have been done.",
            f"Plain: eq. (9), at most {GENERATIONS} generations of {POPULATION}; under A with the moving average "
            "of four (section 2.2) and differences. Ours: the simulated motion fitted to the angles, which needs "
            "no derivatives. ± is half of a 95 % interval.",
            "Least possible: the Cramér–Rao bound for these motions and this noise, each trial's start unknown, "
            "as half of a 95 % interval. No unbiased estimate from the same angles can be surer.",
        ),
        grids=(_grid(rows, true), _error_grid(rows, true)),
        findings=_findings(rows, true),
        document={
            "samples": sum(len(trial.t) for trial in trials),
            "angle_rms_about_mean_deg": spread,
            "rows": [_numbers(row, true) for row in rows],
        },
    )


def _row(arm: Arm, trials: Sequence[Trial], coarse: Sequence[Trial], percent: int, seed: int) -> Row:
    share = percent / 100.0
    exact = noisy_trials(trials, share, seed, "exact")
    filtered = noisy_trials(trials, share, seed, "filtered")
    fits = {
        _PLAIN_A: fit_dynamics(
            arm,
            noisy_trials(trials, share, seed, "differences"),
            objective="torque",
            seed=seed,
            population=POPULATION,
        ),
        _PLAIN_B: fit_dynamics(arm, exact, objective="torque", seed=seed, population=POPULATION),
        _FILTERED: fit_dynamics(arm, filtered, objective="torque", seed=seed),
        _MOTION: fit_dynamics(arm, filtered, seed=seed, objective="motion"),
    }
    samples = sum(len(trial.t) for trial in trials)
    noise = share * angle_spread(trials)
    least = least_std(arm, coarse, noise, samples) if share else np.zeros(len(PARAMETERS))
    return Row(percent, fits, dict(zip(true_values(arm), least.tolist(), strict=True)))


def _grid(rows: Sequence[Row], true: Mapping[str, float]) -> Grid:
    cells: list[tuple[Cell, ...]] = [plain_row(("", "true"), TRUE)]
    for row in rows:
        percent = f"{row.percent} %"
        cells.append(plain_row((percent, "paper"), TABLE3[row.percent]))
        cells += [fitted_row((percent, _said(name, fit)), fit.parameters) for name, fit in row.fits.items()]
        least = (f"{true[name]:.6f} ± {NORMAL_95 * row.least[name]:.2g}" for name in PARAMETERS)
        cells.append((percent, "least possible", *least))
    return Grid("Dynamic parameters", ("noise", "method", *PARAMETERS), tuple(cells))


def _said(name: str, fit: DynamicsFit) -> str:
    return method_said(name, fit, "motion" if name == _MOTION else "torque")


def _error_grid(rows: Sequence[Row], true: Mapping[str, float]) -> Grid:
    header = ("noise", "method", *(f"{name} [%]" for name in INERTIAL), "outside their own 95 % interval")
    cells: list[tuple[Cell, ...]] = []
    for row in rows:
        percent = f"{row.percent} %"
        paper = dict(zip(PARAMETERS, TABLE3[row.percent], strict=True))
        off = (f"{100 * (paper[name] / true[name] - 1):+.2f}" for name in INERTIAL)
        cells.append((percent, "paper", *off, None))
        for method, fit in row.fits.items():
            errors = off_percent(fit.parameters, true)
            missed = ", ".join(outside(fit.parameters, true)) or "none"
            cells.append((percent, _said(method, fit), *(f"{errors[name]:+.2f}" for name in INERTIAL), missed))
        least = (f"±{100 * NORMAL_95 * row.least[name] / true[name]:.2f}" for name in INERTIAL)
        cells.append((percent, "least possible", *least, None))
    return Grid("Errors of the inertial parameters, in percent of their true values", header, tuple(cells))


def _findings(rows: Sequence[Row], true: Mapping[str, float]) -> tuple[str, ...]:
    last = rows[-1]
    motion, exact = last.fits[_MOTION].parameters, last.fits[_PLAIN_B].parameters
    intervals = sum(len(true) for row in rows if row.percent)
    missed = sum(len(outside(row.fits[_MOTION].parameters, true)) for row in rows if row.percent)
    bound = {name: 100 * NORMAL_95 * last.least[name] / true[name] for name in INERTIAL}
    hardest = max(bound, key=lambda name: bound[name])
    return (
        f"A, at {last.percent} %: differences of noisy angles tell nothing; the largest error of an inertial "
        f"parameter is {worst_inertial_percent(last.fits[_PLAIN_A].parameters, true):.0f} %, since noise in the "
        "accelerations shrinks all that they are multiplied with, and friction takes up the law's own damping.",
        f"B, at {last.percent} %: the largest error of an inertial parameter is "
        f"{worst_inertial_percent(exact, true):.2f} % with the plain fit.",
        f"A, at {last.percent} %, simulated motion: "
        + ", ".join(f"{name} {off_percent(motion, true)[name]:+.2f} %" for name in INERTIAL)
        + f". The least possible half-width of a 95 % interval for {hardest} is {bound[hardest]:.1f} %, so no "
        "method can promise 1 % of it from these angles.",
        f"Of {intervals} printed 95 % intervals of the simulated-motion fits {missed} miss the truth; "
        f"{0.05 * intervals:.1f} are expected to.",
    )


def _numbers(row: Row, true: Mapping[str, float]) -> dict[str, object]:
    return {
        "noise_percent": row.percent,
        "paper": dict(zip(PARAMETERS, TABLE3[row.percent], strict=True)),
        "least_std": dict(row.least),
        "methods": {
            name: {
                "parameters": numbers(fit.parameters),
                "worst_inertial_percent": worst_inertial_percent(fit.parameters, true),
                "outside_own_interval": outside(fit.parameters, true),
                "notes": documents(fit.notes),
            }
            for name, fit in row.fits.items()
        },
    }
