"""Fig. 6: how searches converge on the arm's geometry, and from how many starts they get there.

The paper shows one run each of its genetic algorithm, Nelder and Mead's simplex and Newton and Raphson's
iteration. One run shows luck; here each search begins a hundred times, from starts drawn evenly from its box.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from arm.model import Arm, Floats
from fitter.kinematics.tip_basis import coefficients, geometry_of, turning
from fitter.kinematics.tip_sums import tip_sums
from reproduction.bench_data import true_arm, unknown_arm
from reproduction.experiment import Cell, Experiment, Grid, Picture, Settings
from reproduction.searches import SEARCHES, Problem, Trace, bounded_least_squares, trace
from reproduction.table1 import drawn_trials

#: The numbers of eq. (1) that tip positions of the DD arm tell: columns of `GEOMETRY`, joint by joint.
GENES = ((0, 1), (0, 4), (1, 0), (1, 1), (1, 3), (1, 4))
_NAMES = "a1, theta_offset1, alpha2, a2, beta2, theta_offset2"
#: Noise of tip and angles: a row of Table 1.
_TIP_M, _ANGLE_RAD = 1e-3, float(np.deg2rad(1.0))
#: A search has got there when the tip that it predicts is so close to the optimum's, rms.
REACHED_M = 1e-4
#: So close to it a search is stopped, since nothing more is to be learnt of it.
_CLOSE_M = 1e-5
#: The optimum itself is the best that a trust region finds from this many starts, before the comparison.
_SCOUTS, _SCOUT_BUDGET = 20, 3000
_SAMPLES, _BUDGET, _STARTS = 100_000, 50_000, 100
_QUICK_SAMPLES, _QUICK_BUDGET, _QUICK_STARTS = 2_000, 6_000, 2
#: Boxes: half the range of the angles [rad]. The product's own, and one that knows nothing of them.
_BOXES = {"angles within ±30°": np.pi / 6, "angles within ±180°": np.pi}
_COLOURS = dict(zip(SEARCHES, ("#1f4e79", "#a61c3c", "#e07b00", "#3a7d44", "#7a4e9e", "#777777"), strict=True))


@dataclass(frozen=True)
class Landscape:
    """The cost of a geometry: mean square of the tip's error over the samples [m^2]."""

    W: Floats
    z: Floats
    prior: Floats
    revolute: tuple[bool, ...]

    def residuals(self, genes: Floats) -> Floats:
        """Return residuals of many geometries, (n, n_residual) [m]; what no geometry explains is omitted."""
        geometries = np.tile(self.prior, (len(genes), 1, 1))
        for k, place in enumerate(GENES):
            geometries[:, place[0], place[1]] = genes[:, k]
        C = coefficients(self.revolute, geometries)[:, :, 1:]
        return np.asarray((C @ self.W.T - self.z.T).reshape(len(genes), -1), dtype=np.float64)


def landscape(arm: Arm, samples: int, seed: int) -> Landscape:
    """Return the cost of the kinematics for angles drawn from the bench's range, with noise."""
    trial, rng = drawn_trials(arm, samples, seed)[0], np.random.default_rng([seed, 6])
    q = trial.q + _ANGLE_RAD * rng.standard_normal(trial.q.shape)
    assert trial.tip is not None
    tip = trial.tip + _TIP_M * rng.standard_normal(trial.tip.shape)
    whitened = tip_sums(arm, q, tip).whitened()
    scale = 1.0 / np.sqrt(samples)
    return Landscape(scale * whitened.W, scale * whitened.z, geometry_of(unknown_arm(arm)), turning(arm))


def run(settings: Settings) -> Experiment:
    """Start every search a hundred times in each box."""
    samples = settings.samples or (_QUICK_SAMPLES if settings.quick else _SAMPLES)
    budget, starts = (_QUICK_BUDGET, _QUICK_STARTS) if settings.quick else (_BUDGET, _STARTS)
    cost = landscape(true_arm(), samples, settings.seed)
    grids, figures, document, findings = [], [], {}, []
    for box, half in _BOXES.items():
        lower, upper = _bounds(half)
        rng = np.random.default_rng([settings.seed, 7])
        begin = lower + (upper - lower) * rng.random((starts, len(GENES)))
        least = optimum(cost, lower, upper, rng)
        goal = least + _CLOSE_M**2
        traces: dict[str, list[Trace]] = {}
        for name, search in SEARCHES.items():
            settings.progress(f"fig6: {box}, {name}")
            traces[name] = [
                trace(search, Problem(cost.residuals, lower, upper, budget, goal), start, settings.seed + k)
                for k, start in enumerate(begin)
            ]
        rows = {name: _summary(runs, least) for name, runs in traces.items()}
        grids.append(_grid(box, rows, starts, budget))
        figures.append((box, traces, least))
        document[box] = rows
        findings.append(_finding(box, rows))
    return Experiment(
        name="fig6",
        title="Fig. 6: convergence of the searches",
        assumptions=(
            f"The problem is eq. (3) of the DD arm: mean square error of the tip over {samples} positions with 1 "
            f"mm and 1° of noise (Table 1). Sought are the six numbers that tip positions tell ({_NAMES}), "
            "lengths within 0 to 1 m, angles within the box that is named; starts are drawn evenly from that "
            "box.",
            f"A search has reached the optimum when the tip it predicts is within {1e3 * REACHED_M:g} mm (rms "
            f"over all samples) of the optimum's, which is the best that a trust region finds from {_SCOUTS} "
            f"starts of its own; within {1e3 * _CLOSE_M:g} mm it is stopped.",
            f"Each search may evaluate {budget} geometries, 500 generations of 100; slopes are differences and "
            "count. The samples are reduced to sums beforehand for all of them. Newton–Raphson is the plain "
            "iteration x + J⁺Δr, without damping or bounds. GA and differential evolution draw their populations "
            "from the box and take no start.",
            "The paper prints one run each, with neither data nor start.",
        ),
        grids=tuple(grids),
        pictures=(
            Picture(_figure(figures), "Tip error above the optimum's: median and middle half of all starts"),
        ),
        findings=tuple(findings),
        document={"samples": samples, "starts": starts, "budget": budget, "boxes": document},
    )


def optimum(cost: Landscape, lower: Floats, upper: Floats, rng: np.random.Generator) -> float:
    """Return the least cost in a box, by a trust region from many starts."""
    found = np.inf
    for start in lower + (upper - lower) * rng.random((_SCOUTS, len(GENES))):
        run = trace(bounded_least_squares, Problem(cost.residuals, lower, upper, _SCOUT_BUDGET), start, 0)
        found = min(found, float(run.best[-1]))
    return found


def _bounds(half: float) -> tuple[Floats, Floats]:
    length = np.array([column == 1 for _, column in GENES])
    return np.where(length, 0.0, -half), np.where(length, 1.0, half)


def excess_m(run: Trace, least: float) -> Floats:
    """Return how far, rms, the tip of the best so far is from that of the optimum [m]."""
    return np.sqrt(np.maximum(run.best - least, 0.0))


def _summary(runs: Sequence[Trace], least: float) -> dict[str, float | None]:
    """Return the share of runs that got there, and the medians of those that did."""
    first = [np.flatnonzero(excess_m(run, least) < REACHED_M) for run in runs]
    there = [(run, int(k[0])) for run, k in zip(runs, first, strict=True) if len(k)]
    needed = [float(run.evaluations[k]) for run, k in there]
    seconds = [run.seconds * run.evaluations[k] / run.evaluations[-1] for run, k in there]
    return {
        "share": len(there) / len(runs),
        "median_evaluations": float(np.median(needed)) if needed else None,
        "median_seconds": float(np.median(seconds)) if seconds else None,
        "median_error_mm": float(np.median([1e3 * excess_m(run, least)[-1] for run in runs])),
    }


def _grid(box: str, rows: Mapping[str, Mapping[str, float | None]], starts: int, budget: int) -> Grid:
    cells: list[tuple[Cell, ...]] = []
    for name, row in rows.items():
        evaluations, seconds, error = row["median_evaluations"], row["median_seconds"], row["median_error_mm"]
        cells.append(
            (
                name,
                f"{100 * (row['share'] or 0.0):.0f} %",
                None if evaluations is None else f"{evaluations:.0f}",
                None if seconds is None else f"{1e3 * seconds:.1f}",
                f"{error:.3g}",
            )
        )
    header = ("search", "reached", "evaluations until then", "time until then [ms]", "error at the end [mm]")
    title = f"{starts} starts each, {budget} evaluations, {box} (medians; the first two of those that got there)"
    return Grid(title, header, tuple(cells))


def _figure(parts: Sequence[tuple[str, Mapping[str, Sequence[Trace]], float]]) -> Figure:
    figure = Figure(figsize=(12, 4.6), layout="constrained")
    rows = figure.subplots(1, len(parts), sharey=True, squeeze=False)[0]
    for axes, (box, traces, least) in zip(rows, parts, strict=True):
        for name, runs in traces.items():
            _curve(axes, name, runs, least)
        axes.axhline(1e3 * REACHED_M, color="black", lw=0.8, ls=":")
        axes.set(xscale="log", yscale="log", xlabel="evaluations", title=box)
        axes.grid(alpha=0.25)
    rows[0].set_ylabel("tip error above the optimum's [mm rms]")
    rows[0].legend(frameon=False, loc="lower left")
    return figure


def _curve(axes: Axes, name: str, runs: Sequence[Trace], least: float) -> None:
    """Draw the median over the runs, and between the quartiles, of the error after this many evaluations."""
    last = max(run.evaluations[-1] for run in runs)
    x = np.unique(np.geomspace(1, last, 200).astype(int))
    lines = []
    for run in runs:
        k = np.searchsorted(run.evaluations, x, side="right") - 1
        lines.append(np.where(k >= 0, 1e3 * excess_m(run, least)[np.maximum(k, 0)], np.nan))
    seen = np.flatnonzero(~np.isnan(lines).any(axis=0))
    low, middle, high = np.maximum(np.percentile(np.array(lines)[:, seen], [25, 50, 75], axis=0), 1e-6)
    axes.plot(x[seen], middle, color=_COLOURS[name], lw=1.6, label=name)
    axes.fill_between(x[seen], low, high, color=_COLOURS[name], alpha=0.12, lw=0)


def _finding(box: str, rows: Mapping[str, Mapping[str, float | None]]) -> str:
    said = ", ".join(f"{name} from {100 * (row['share'] or 0.0):.0f} %" for name, row in rows.items())
    return f"With {box}, the optimum is reached by {said} of the starts."
