"""The pictures of a diagnosis: what is wrong, where the error lives, the motion before and after, the rivals."""

from collections.abc import Callable, Sequence

import numpy as np
import scipy
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.basis_functions import variable
from fitter.diagnosis.diagnosis import Diagnosis
from fitter.report.diagnosis_traces import Trace, turns, unit_of
from fitter.report.figures import MEASURED, png

BEFORE, AFTER = "#e07b00", "#12693c"
_WORDS = {BEFORE: "before", AFTER: "after"}
#: Columns of trials in a picture, and bars of candidates.
_SHOWN, _BARS = 3, 12
#: Bins of a variable that hold equally many samples, and the fewest that one of a map needs to be drawn.
_BINS, _LEAST = 24, 20


def residual_figure(found: Diagnosis, all_traces: Sequence[Trace]) -> bytes:
    """Draw the residual torque over time, in the evaluating trials in which it is largest.

    Returns
    -------
    bytes
        PNG.
    """
    worst = _worst(all_traces, lambda trace: trace.torque_square)
    figure, axes = _grid(found, len(worst), [2.0])
    for column, trace in zip(axes.T, worst, strict=True):
        column[0].set_title(trace.motion.trial.name, fontsize=9)
        for j, panel in enumerate(column):
            for values, colour in zip(trace.residuals, (BEFORE, AFTER), strict=False):
                panel.plot(trace.motion.trial.t, values[:, j], color=colour, lw=1.1, label=_WORDS[colour])
            panel.axhline(0.0, color="#888888", lw=0.6)
    for j, panel in enumerate(axes[:, 0]):
        panel.set_ylabel(f"torque left {j + 1} [{unit_of(found, j)}]")
    axes[0, 0].legend(frameon=False, fontsize=8, ncols=2)
    for panel in axes[-1]:
        panel.set_xlabel("time in the trial [s]")
    return png(figure)


def angles_figure(found: Diagnosis, all_traces: Sequence[Trace]) -> bytes:
    """Draw measured and simulated angles, in the evaluating trials in which they are farthest apart.

    Returns
    -------
    bytes
        PNG.
    """
    worst = _worst(all_traces, lambda trace: trace.angle_error)
    n_joint = found.regression.arm.n_joint
    figure, axes = _grid(found, len(worst), [2.2, 1.2])
    for column, trace in zip(axes.T, worst, strict=True):
        t = trace.motion.trial.t
        column[0].set_title(trace.motion.trial.name, fontsize=9)
        for j in range(n_joint):
            above, below = column[2 * j], column[2 * j + 1]
            scale = np.rad2deg(1.0) if turns(found, j) else 1e3
            q = scale * trace.motion.trial.q[:, j]
            above.plot(t, q, color=MEASURED, lw=4.5, alpha=0.35, label="measured")
            for values, colour in zip(trace.simulated, (BEFORE, AFTER), strict=False):
                angles = scale * values[:, j]
                above.plot(t, angles, color=colour, lw=1.2, label=f"simulated, {_WORDS[colour]}")
                below.plot(t, angles - q, color=colour, lw=1.2)
            below.axhline(0.0, color="#888888", lw=0.6)
    for j in range(n_joint):
        unit = "deg" if turns(found, j) else "mm"
        axes[2 * j, 0].set_ylabel(f"joint {j + 1} [{unit}]")
        axes[2 * j + 1, 0].set_ylabel(f"error [{unit}]")
    axes[0, 0].legend(frameon=False, fontsize=8)
    for panel in axes[-1]:
        panel.set_xlabel("time in the trial [s]")
    return png(figure)


def places_figure(found: Diagnosis, all_traces: Sequence[Trace]) -> bytes:
    """Draw where the error lives: the residual torque against what the joint does, time, frequency and trial.

    Means over bins, and where the middle half of the samples is; evaluating trials alone but for the last panel.

    Returns
    -------
    bytes
        PNG.
    """
    judging = [trace for trace in all_traces if not trace.motion.learn]
    n_joint = found.regression.arm.n_joint
    figure = Figure(figsize=(15, 2.1 * n_joint + 0.3))
    axes = figure.subplots(n_joint, 7, squeeze=False)
    _space(figure, axes.shape, (0.75, 0.55), (0.62, 0.5))
    for j in range(n_joint):
        angle, unit = ("rad", "rad/s") if turns(found, j) else ("m", "m/s")
        columns = [
            (f"q{j + 1} [{angle}]", [trace.motion.q[:, j] for trace in judging]),
            (f"dq{j + 1} [{unit}]", [trace.motion.dq[:, j] for trace in judging]),
            (f"ddq{j + 1} [{unit}²]", [trace.motion.ddq[:, j] for trace in judging]),
            ("time of the run [s]", [trace.motion.t for trace in judging]),
        ]
        signs = [trace.motion.direction[:, j] for trace in judging]
        for k, colour in enumerate((BEFORE, AFTER)[: len(judging[0].residuals)]):
            residual = np.concatenate([trace.residuals[k][:, j] for trace in judging])
            for panel, (_, values) in zip(axes[j], columns, strict=False):
                _binned(panel, np.concatenate(values), residual, colour)
            _by_sign(axes[j, 4], np.concatenate(signs), residual, colour, k)
            _by_frequency(axes[j, 5], found, judging, (k, j), colour)
            _by_trial(axes[j, 6], all_traces, (k, j), colour)
        for panel, (label, _) in zip(axes[j], columns, strict=False):
            panel.set_xlabel(label, fontsize=8)
        axes[j, 4].set_xlabel(f"sign(dq{j + 1})", fontsize=8)
        axes[j, 4].set_xticks([-1, 1])
        axes[j, 5].set_xlabel("frequency [Hz], amplitude a √Hz", fontsize=8)
        axes[j, 6].set_xlabel("trial, rms (shaded: learnt from)", fontsize=8)
        axes[j, 0].set_ylabel(f"torque left {j + 1} [{unit_of(found, j)}]", fontsize=8)
        for panel in axes[j]:
            panel.tick_params(which="both", labelsize=6.5)
            panel.grid(alpha=0.2)
    axes[0, 0].legend(frameon=False, fontsize=8)
    return png(figure)


def remainder_figure(found: Diagnosis, all_traces: Sequence[Trace]) -> bytes:
    """Draw the residual against the one or two variables that it depends on most.

    Returns
    -------
    bytes
        PNG.
    """
    discrepancy, judging = found.finding.discrepancy, [trace for trace in all_traces if not trace.motion.learn]
    j, names = discrepancy.joint - 1, discrepancy.depends_on[:2]
    residual = np.concatenate([trace.residuals[-1][:, j] for trace in judging])
    values = [np.concatenate([variable(trace.motion, name) for trace in judging]) for name in names]
    figure = Figure(figsize=(7, 3.6), layout="constrained")
    panel = figure.subplots()
    panel.set_xlabel(names[0])
    label = f"torque left {j + 1} [{unit_of(found, j)}]"
    if len(names) == 1:
        _binned(panel, values[0], residual, AFTER if len(judging[0].residuals) > 1 else BEFORE)
        panel.set_ylabel(label)
        return png(figure)
    seen = np.isfinite(residual)
    count, x, y = np.histogram2d(values[0][seen], values[1][seen], bins=_BINS)
    total, _, _ = np.histogram2d(values[0][seen], values[1][seen], bins=(x, y), weights=residual[seen])
    mean = np.where(count >= _LEAST, total / np.maximum(count, 1.0), np.nan)
    top = float(np.nanmax(np.abs(mean))) if np.isfinite(mean).any() else 1.0
    drawn = panel.pcolormesh(x, y, mean.T, cmap="RdBu_r", vmin=-top, vmax=top)
    figure.colorbar(drawn, ax=panel, label=label)
    panel.set_ylabel(names[1])
    return png(figure)


def gains_figure(labels: Sequence[str], gains: Sequence[float], colours: Sequence[str]) -> bytes:
    """Draw how much of the squared residual every candidate takes away, the best on top, no more than a dozen.

    Returns
    -------
    bytes
        PNG.
    """
    n = min(len(labels), _BARS)
    figure = Figure(figsize=(9, 0.32 * n + 0.9), layout="constrained")
    axes = figure.subplots()
    axes.barh(range(n), 100.0 * np.array(gains[:n]), color=colours[:n], height=0.65)
    axes.set_yticks(range(n), labels[:n], fontsize=8)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel("of the squared residual of the evaluating trials, taken away [%]")
    axes.grid(alpha=0.25, axis="x")
    return png(figure)


def _worst(all_traces: Sequence[Trace], size: Callable[[Trace], float]) -> list[Trace]:
    judging = [trace for trace in all_traces if not trace.motion.learn]
    return sorted(judging, key=size, reverse=True)[:_SHOWN]


def _grid(found: Diagnosis, columns: int, heights: list[float]) -> tuple[Figure, NDArray[np.object_]]:
    """Return panels: a column a trial, for every joint rows of these heights."""
    n_joint = found.regression.arm.n_joint
    figure = Figure(figsize=(4.2 * columns + 0.6, sum(heights) * n_joint + 0.8))
    axes = figure.subplots(
        len(heights) * n_joint,
        columns,
        squeeze=False,
        sharex="col",
        sharey="row",
        height_ratios=heights * n_joint,
    )
    _space(figure, axes.shape, (0.8, 0.5), (0.15, 0.15))
    for panel in axes.flat:
        panel.grid(alpha=0.25)
    return figure, axes


def _space(
    figure: Figure, shape: tuple[int, ...], margins: tuple[float, float], gaps: tuple[float, float]
) -> None:
    """Place panels by their margins at the left and below and the gaps between them, across and down [in].

    Matplotlib can find these, but draws everything once more for it, and many panels take seconds.
    """
    (wide, high), (rows, columns) = figure.get_size_inches(), shape
    (left, below), (across, down), rest = margins, gaps, 0.3
    width = (wide - left - rest / 2.0 - (columns - 1) * across) / columns
    height = (high - below - rest - (rows - 1) * down) / rows
    figure.subplots_adjust(
        left=left / wide,
        right=1.0 - rest / 2.0 / wide,
        bottom=below / high,
        top=1.0 - rest / high,
        wspace=across / width,
        hspace=down / height,
    )


def _binned(panel: Axes, x: Floats, residual: Floats, colour: str) -> None:
    """Draw the mean residual in bins of equally many samples, and where the middle half of it is."""
    seen = np.isfinite(residual)
    x, residual = x[seen], residual[seen]
    if len(x) < _BINS:
        return
    order = np.argsort(x, kind="stable")
    parts = np.array_split(order, _BINS)
    middle = [float(x[part].mean()) for part in parts]
    first, third = np.array([np.quantile(residual[part], [0.25, 0.75]) for part in parts]).T
    panel.fill_between(middle, first, third, color=colour, alpha=0.2, lw=0)
    panel.plot(
        middle, [float(residual[part].mean()) for part in parts], color=colour, lw=1.3, label=_WORDS[colour]
    )


def _by_sign(panel: Axes, sign: Floats, residual: Floats, colour: str, k: int) -> None:
    for side in (-1.0, 1.0):
        some = residual[(sign == side) & np.isfinite(residual)]
        if len(some):
            first, third = np.quantile(some, [0.25, 0.75])
            mean, x = float(some.mean()), side + 0.2 * k
            panel.plot([x, x], [first, third], color=colour, lw=5, alpha=0.3)
            panel.plot([x], [mean], "o", color=colour, ms=5)
    panel.set_xlim(-1.8, 1.8)


def _by_frequency(
    panel: Axes, found: Diagnosis, judging: Sequence[Trace], which: tuple[int, int], colour: str
) -> None:
    """Draw the root of the mean power spectrum; where a joint is stuck there is none."""
    k, j = which
    dt_s = max(trace.motion.dt_s for trace in judging)
    size = max(len(trace.motion.t) for trace in judging)
    power = np.zeros(size // 2 + 1)
    for trace in judging:
        residual = np.nan_to_num(trace.residuals[k][:, j])
        f, one = scipy.signal.periodogram(residual, 1.0 / dt_s, nfft=size, detrend=False)
        power = power + one / len(judging)
    seen = (f > 0.0) & (f <= found.regression.weighting.seen_hz)
    panel.plot(f[seen], np.sqrt(power[seen]), color=colour, lw=0.9)
    panel.set_yscale("log")


def _by_trial(panel: Axes, all_traces: Sequence[Trace], which: tuple[int, int], colour: str) -> None:
    k, j = which
    for trace in all_traces:
        residual = trace.residuals[k][:, j]
        if np.isfinite(residual).any():
            panel.plot(trace.motion.number, np.sqrt(np.nanmean(residual**2)), "o", color=colour, ms=3)
    learnt = sum(trace.motion.learn for trace in all_traces)
    if k == 0:
        panel.axvspan(0.5, learnt + 0.5, color=MEASURED, alpha=0.08, lw=0)
    panel.set_xlim(0.5, len(all_traces) + 0.5)
    panel.set_ylim(bottom=0.0)
