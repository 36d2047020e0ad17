"""Table 6: the dynamics from more and more data."""

from collections.abc import Mapping, Sequence

import numpy as np

from arm.model import Arm
from fitter.dynamics.dynamics_fit import DynamicsFit
from fitter.dynamics.fit import fit_dynamics
from fitter.dynamics.torque_search import GENERATIONS
from fitter.report.published import PARAMETERS, TABLE6, TRUE
from limbcal.note import documents
from reproduction.bench_data import angle_spread, bench_trials, noisy_trials, true_arm
from reproduction.experiment import Cell, Experiment, Grid, Settings
from reproduction.parameter_rows import (
    fitted_row,
    method_said,
    numbers,
    outside,
    plain_row,
    worst_inertial_percent,
)

POPULATION = 100
#: Noise of the angles: as in Table 3's mildest row.
_SHARE = 0.03
_PLAIN, _EXACT, _MOTION = "plain, differences", "plain, derivatives exact", "ours, simulated motion"
Fits = Mapping[str, DynamicsFit]


def run(settings: Settings) -> Experiment:
    """Repeat Table 6 with the same motions at four rates."""
    arm, true = true_arm(), dict(zip(PARAMETERS, TRUE, strict=True))
    counts = list(TABLE6)[:1] if settings.quick else list(TABLE6)
    found = {}
    for count in counts:
        settings.progress(f"table6: {count} data")
        found[count] = _fits(arm, count, settings.seed)
    spread = np.rad2deg(_SHARE * angle_spread(bench_trials(arm, counts[0], settings.seed)))
    return Experiment(
        name="table6",
        title="Table 6: dynamics from more and more data",
        assumptions=(
            "Which data make up the 1000 is not printed. The first 1000 at 32 µs are 32 ms of rest; so the five "
            "learning motions are taken whole each time, at the rate that gives this many samples.",
            f"Without noise any number of data gives the same answer. The angles have {100 * _SHARE:.0f} % of "
            f"white noise ({', '.join(f'{x:.2f}°' for x in spread)}), as in Table 3; targets, law (5) and its "
            "gains are known.",
            f"Plain: eq. (9), at most {GENERATIONS} generations of {POPULATION}, velocities and accelerations by "
            "the moving average of four and differences, or exact. Ours: the simulated motion fitted to the "
            "angles. ± is half of a 95 % interval.",
        ),
        grids=(_grid(found), _error_grid(found, true)),
        findings=_findings(found, true),
        document={
            "noise_percent": 100 * _SHARE,
            "rows": [
                {
                    "data": count,
                    "paper": dict(zip(PARAMETERS, TABLE6[count], strict=True)),
                    "methods": {
                        name: {
                            "parameters": numbers(fit.parameters),
                            "worst_inertial_percent": worst_inertial_percent(fit.parameters, true),
                            "outside_own_interval": outside(fit.parameters, true),
                            "notes": documents(fit.notes),
                        }
                        for name, fit in fits.items()
                    },
                }
                for count, fits in found.items()
            ],
        },
    )


def _fits(arm: Arm, count: int, seed: int) -> Fits:
    trials = bench_trials(arm, count, seed)
    seen = {kind: noisy_trials(trials, _SHARE, seed, kind) for kind in ("differences", "exact")}
    return {
        _PLAIN: fit_dynamics(arm, seen["differences"], objective="torque", seed=seed, population=POPULATION),
        _EXACT: fit_dynamics(arm, seen["exact"], objective="torque", seed=seed, population=POPULATION),
        _MOTION: fit_dynamics(arm, noisy_trials(trials, _SHARE, seed), seed=seed, objective="motion"),
    }


def _grid(found: Mapping[int, Fits]) -> Grid:
    cells: list[tuple[Cell, ...]] = [plain_row(("", "true"), TRUE)]
    for count, fits in found.items():
        cells.append(plain_row((str(count), "paper"), TABLE6[count]))
        cells += [
            fitted_row(
                (str(count), method_said(name, fit, "motion" if name == _MOTION else "torque")), fit.parameters
            )
            for name, fit in fits.items()
        ]
    return Grid("Dynamic parameters", ("data", "method", *PARAMETERS), tuple(cells))


def _error_grid(found: Mapping[int, Fits], true: Mapping[str, float]) -> Grid:
    cells = []
    for count, fits in found.items():
        paper = max(abs(100 * (value / true[n] - 1)) for n, value in _inertial(TABLE6[count]))
        own = (f"{worst_inertial_percent(fit.parameters, true):.2f}" for fit in fits.values())
        missed = ", ".join(outside(fits[_MOTION].parameters, true)) or "none"
        cells.append((str(count), f"{paper:.2f}", *own, missed))
    header = ("data", "paper", _PLAIN, _EXACT, _MOTION, "ours outside its own 95 % interval")
    return Grid("Largest error of an inertial parameter, in percent of its true value", header, tuple(cells))


def _inertial(values: Sequence[float]) -> list[tuple[str, float]]:
    return list(zip(PARAMETERS, values, strict=True))[:4]


def _findings(found: Mapping[int, Fits], true: Mapping[str, float]) -> tuple[str, ...]:
    fewest, most = min(found), max(found)
    width = {count: fits[_MOTION].parameters["I2"].std for count, fits in found.items()}
    errors = {
        name: [worst_inertial_percent(fits[name].parameters, true) for fits in found.values()]
        for name in (_PLAIN, _MOTION)
    }
    return (
        f"Ours: the standard error of I2 falls from {width[fewest]:.2g} with {fewest} data to {width[most]:.2g} "
        f"with {most}, by {width[fewest] / width[most]:.1f} where the square root of the numbers' ratio is "
        f"{np.sqrt(most / fewest):.1f}.",
        "Plain, with differences: the largest error of an inertial parameter is "
        + ", ".join(f"{x:.0f} %" for x in errors[_PLAIN])
        + f" with {', '.join(map(str, found))} data; the closer the samples, the more noise differences make "
        "of it, and more data are worse.",
    )
