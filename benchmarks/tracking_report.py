"""What the comparison of trackers found: scores, as a table, a page and a picture."""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from arm.model import Floats

TITLES = {
    "standard": "standard: the two-joint arm in the horizontal plane",
    "imperfect": "imperfect: sensors sit and read not quite as the arm file says",
    "vertical": "vertical: the two-joint arm in a vertical plane",
    "spatial": "spatial: the three-joint arm",
    "noisy": "noisy: standard with five times the noise and bias",
}
COLOURS = {
    "integration, first rest": "#a61c3c",
    "integration, each rest": "#e07b00",
    "filter": "#1f77b4",
    "smoother": "#2e7d32",
    "filter, self-calibrated": "#7b3fa0",
    "smoother, self-calibrated": "#202020",
}
#: Of each stretch of this length a picture shows the largest error [s].
_SHOWN_S = 0.1
#: Errors below this are drawn as this.
_FLOOR_DEG = 3e-4
_TEXT = """# Trackers compared

What the paper's double integration, the live filter and the smoother make of the same readings: the first motions
of each bench, {seconds:g} s at 32 kHz on one clock, {drawn}.
{start}
Nobody tells them where one motion ends and the next begins. `python -m benchmarks.tracking` makes this page.

{benches}

- *Integration* is the paper's method. With *first rest* velocities are zeroed before the first motion only, as in
  the paper; with *each rest* whenever the arm is seen to rest.
- *Self-calibrated* trackers take the sensors to be as they were found from these same readings; the others take
  them to be as the arm file says.{cost}
- *Mean* and *largest error* are of each joint's absolute error over the whole time, frame by frame at the frame's
  own time, joints from the base on; of each the median over the seeds.
- *Within 3 std* is the share of all angles that are no further off than three of the standard deviations that
  the tracker itself claims. Integration claims none.
- *CPU* is one core's time, the mean over the seeds: for each second of stream where tracking is live; for the
  whole recording, decimation included, where it is smoothed.
- *Least mean error* is the Cramér–Rao bound for the smoother's problem, as the mean absolute error of a normal
  distribution of that spread. It holds for averages over many recordings: with one draw of noise and offsets a
  tracker may be luckier, and medians lie below averages. It holds for what the smoother believes beforehand, and
  the bench is kinder than that: a rest is exact, where the smoother allows for a speed that noise could hide. With
  imperfect mounting it is the bound for who does not know the sensors' mountings. `benchmarks/cramer_rao.py` says
  precisely what it is."""
_TOLD = "Every tracker knows where the arm rests at the start."
_UNTOLD = """No tracker knows where the arm rests at the start: integration begins at zero, the others look
where gravity points and begin at zero where it does not show."""
_CAPTION = """Seed {seed}: the largest error in each tenth of a second. Dashed, over a shaded band: three of the
standard deviations that filter and smoother claim."""


@dataclass(frozen=True)
class Track:
    """What a tracker made of a recording: t (n,), q and its claimed deviation (n, n_joint), in what CPU time."""

    t: Floats
    q: Floats
    q_std: Floats | None
    cpu_s: float
    notes: dict[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Trace:
    """Largest absolute error and largest claim of each stretch: t (n,) [s], both (n, n_joint) [deg]."""

    t: Floats
    error: Floats
    claim: Floats | None


@dataclass(frozen=True)
class Score:
    """How one tracker did on one recording: absolute errors by joint, share within three claimed deviations."""

    mean_deg: list[float]
    max_deg: list[float]
    within: float | None
    cpu_s: float
    notes: dict[str, object]
    trace: Trace


@dataclass(frozen=True)
class Run:
    """One bench with one seed: how long it lasted, how each tracker did, and the least mean error by joint."""

    case: str
    seed: int
    seconds: float
    scores: dict[str, Score]
    least_deg: list[float]

    def document(self) -> dict[str, object]:
        """Return all but the traces."""
        scores = {
            name: {
                "mean_deg": score.mean_deg,
                "max_deg": score.max_deg,
                "within_3_std": score.within,
                "cpu_s": score.cpu_s,
                **score.notes,
            }
            for name, score in self.scores.items()
        }
        return {
            "bench": self.case,
            "seed": self.seed,
            "seconds": self.seconds,
            "trackers": scores,
            "least_mean_deg": self.least_deg,
        }


def score(track: Track, clock: Floats, true: Floats) -> Score:
    """Compare a track with the truth, (n_sample, n_joint) at the times ``clock``, at the track's own times."""
    there = np.column_stack([np.interp(track.t, clock, true[:, j]) for j in range(true.shape[1])])
    error = np.rad2deg(np.abs(track.q - there))
    claim = None if track.q_std is None else np.rad2deg(3.0 * track.q_std)
    within = None if claim is None else float(np.mean(error <= claim))
    stretch = max(1, round(_SHOWN_S / float(track.t[1] - track.t[0])))
    begins = np.arange(0, len(track.t), stretch)
    largest = None if claim is None else np.maximum.reduceat(claim, begins)
    trace = Trace(track.t[begins], np.maximum.reduceat(error, begins), largest)
    means, maxima = error.mean(axis=0).tolist(), error.max(axis=0).tolist()
    return Score(means, maxima, within, track.cpu_s, track.notes, trace)


def _cases(runs: Sequence[Run]) -> dict[str, list[Run]]:
    return {case: [run for run in runs if run.case == case] for case in dict.fromkeys(run.case for run in runs)}


def table(runs: Sequence[Run]) -> str:
    """Return the Markdown table: medians over seeds, share and time as means."""
    rows = [
        "| bench | tracker | mean error [deg] | largest error [deg] | within 3 std | CPU |",
        "|---|---|--:|--:|--:|--:|",
    ]
    for case, some in _cases(runs).items():
        first = case
        for name in some[0].scores:
            scores = [run.scores[name] for run in some]
            claims = [score.within for score in scores if score.within is not None]
            share = f"{100.0 * np.mean(claims):.1f} %" if claims else "–"
            took = float(np.mean([score.cpu_s for score in scores]))
            live = f"{took / some[0].seconds:.3f} s/s" if not name.startswith("smoother") else f"{took:.1f} s"
            mean, largest = _median([s.mean_deg for s in scores]), _median([s.max_deg for s in scores])
            rows.append(f"| {first} | {name} | {mean} | {largest} | {share} | {live} |")
            first = ""
        rows.append(f"| | *least mean error* | *{_median([run.least_deg for run in some])}* | | | |")
    return "\n".join(rows)


def _median(values: Sequence[Sequence[float]]) -> str:
    return ", ".join(_figures(value) for value in np.median(np.array(values), axis=0))


def _figures(value: float) -> str:
    """Return two significant figures, never as a power of ten."""
    return f"{value:.{max(0, 1 - int(np.floor(np.log10(max(value, 1e-9)))))}f}"


def page(runs: Sequence[Run], initial: bool, picture: str | None) -> str:
    """Return the table with what explains it, in Markdown; ``picture`` is its plot as seen from it."""
    seeds = list(dict.fromkeys(run.seed for run in runs))
    drawn = f"seed {seeds[0]}" if len(seeds) == 1 else f"{len(seeds)} seeds, {min(seeds)} to {max(seeds)}"
    notes = [score.notes.get("calibration_cpu_s") for run in runs for score in run.scores.values()]
    calibrating = [took for took in notes if isinstance(took, float)]
    cost = f" Finding that took {np.mean(calibrating):.0f} s." if calibrating else ""
    benches = "\n".join(f"- *{TITLES[case].replace(':', '*:')}" for case in _cases(runs))
    start = _TOLD if initial else _UNTOLD
    text = _TEXT.format(seconds=runs[0].seconds, drawn=drawn, start=start, benches=benches, cost=cost)
    parts = [text, table(runs)]
    if picture is not None:
        parts.append(f"![Error of every joint over time]({picture})")
        parts.append(_CAPTION.format(seed=seeds[0]))
    return "\n\n".join(parts) + "\n"


def draw(runs: Sequence[Run]) -> bytes:
    """Draw one panel a bench: the error of every joint over time, and what filter and smoother claim of it.

    Returns
    -------
    bytes
        PNG.
    """
    figure = Figure(figsize=(13, 3.1 * len(runs) + 0.6), layout="constrained")
    panels = figure.subfigures(len(runs), 1, squeeze=False)[:, 0]
    shown: dict[str, Artist] = {}
    for panel, run in zip(panels, runs, strict=True):
        panel.suptitle(TITLES[run.case], fontsize=11, fontweight="bold")
        axes = panel.subplots(1, len(run.least_deg), sharey=True, squeeze=False)[0]
        for joint, ax in enumerate(axes):
            shown |= _errors(ax, run, joint)
            ax.set_title(f"joint {joint + 1}", fontsize=9)
            ax.set_xlabel("time [s]", fontsize=9)
        top = max(max(score.max_deg) for score in run.scores.values())
        axes[0].set_ylim(_FLOOR_DEG, 2.0 * top)
        axes[0].set_ylabel("error [deg]")
    figure.legend(list(shown.values()), list(shown), loc="outside upper center", ncols=3, fontsize=9)
    buffer = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(buffer, format="png", dpi=90, metadata={"Software": None})
    return buffer.getvalue()


def _errors(ax: Axes, run: Run, joint: int) -> dict[str, Artist]:
    """Draw one joint's errors; return what the legend is to name."""
    shown: dict[str, Artist] = {}
    alpha = 0.26 / max(1, sum(score.within is not None for score in run.scores.values()))
    for name, score in run.scores.items():
        trace, colour = score.trace, COLOURS[name]
        if trace.claim is not None:
            ax.fill_between(trace.t, _FLOOR_DEG, trace.claim[:, joint], color=colour, alpha=alpha, lw=0)
            ax.plot(trace.t, trace.claim[:, joint], color=colour, lw=0.9, ls=(0, (4, 2)))
        error = np.maximum(trace.error[:, joint], _FLOOR_DEG)
        (shown[name],) = ax.plot(trace.t, error, color=colour, lw=1.2)
    ax.set_yscale("log")
    ax.set_xlim(0.0, run.seconds)
    ax.grid(alpha=0.25)
    return shown
