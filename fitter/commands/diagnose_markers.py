"""`fitter diagnose` of recordings of markers: whether they contradict a calibrated limb, and which of them."""

import argparse
import math
from pathlib import Path

from rich.markup import escape
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from arm.arm_file import save_arm
from arm.effects.catalogue import catalogue
from arm.model import Arm
from fitter.commands.limb_kinematics import recordings_of
from fitter.diagnosis.finding import UNKNOWN, UNKNOWN_ERRORS, UNKNOWN_RESIDUAL
from fitter.marker_diagnosis.marker_finding import MarkerFinding, MarkerNumber, NamedMarkerCause, diagnose_markers
from limbcal.command import Document, console, say_notes, show, to_json, with_asked
from limbcal.digits import with_interval
from limbcal.errors import ConfigError, DeviceError
from limbcal.escaped import escaped
from limbcal.note import documents

_SENTENCES = {
    "named": "The markers contradict the limb, and this is why:",
    "ambiguous": "The markers contradict the limb; these explain it equally well:",
    "none": "The markers agree with the limb: no marker is farther off than markers wander.",
    "unexplained": "The markers contradict the limb, and no effect of the catalogue explains it.",
}


#: Options of a diagnosis of joint motion, and what they are where they are not given.
_NOT_HERE: tuple[tuple[str, object], ...] = (
    ("columns", None),
    ("rate_hz", None),
    ("deny", None),
    ("no_torque", False),
    ("judge", []),
)


def diagnose_marker_files(arm: Arm, arguments: argparse.Namespace) -> Document:
    """Diagnose the markers, write everything, and say it.

    Raises
    ------
    ConfigError
        If there are no trials to judge on, or an option is for joint motion.
    DeviceError
        If a file cannot be written.
    """
    mistakes = [
        f"--{name.replace('_', '-')} is given, expected it only with joint motion"
        for name, usual in _NOT_HERE
        if getattr(arguments, name) != usual
    ]
    if not arguments.evaluate:
        mistakes.append("--evaluate is missing; expected recordings to judge on, other than those to learn from")
    if mistakes:
        raise ConfigError(mistakes)
    learn, evaluate, out = arguments.learn, arguments.evaluate, arguments.out
    recordings, notes = recordings_of([*learn, *evaluate])
    labels = [Path(recording.path).stem for recording in recordings]
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("tracking", total=None)
        finding = diagnose_markers(
            arm,
            recordings[: len(learn)],
            recordings[len(learn) :],
            labels,
            progress=lambda what: bar.update(task, description=what),
        )
    say_notes(notes)
    answer: Document = with_asked({**document(finding), "notes": documents(notes)})
    try:
        (out / "diagnosis.json").write_text(to_json(answer), encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{out}: cannot be written: {error.strerror}") from error
    save_arm(finding.arm, out / "extended.toml")
    from fitter.report.marker_diagnosis import write_marker_report

    write_marker_report(finding, [described(cause) for cause in finding.causes], _SENTENCES[finding.verdict], out)
    show(_SENTENCES[finding.verdict])
    for cause in finding.causes:
        show(f"  {described(cause)}")
    show(_distances(finding))
    show(f"next: {finding.next_experiment}")
    show(f"report: {out / 'report.html'}")
    return answer


def _distances(finding: MarkerFinding) -> Table:
    table = Table(escape("rms distance in evaluating trials [mm]"), "before", "after")
    table.add_row("all markers", *(f"{value:.1f}" for value in finding.rms_mm))
    for name in dict.fromkeys(name for cause in finding.causes for name in cause.markers):
        table.add_row(Text(escaped(name)), f"{finding.before[name]:.1f}", f"{finding.after[name]:.1f}")
    return table


def document(finding: MarkerFinding) -> Document:
    """Return the JSON document; torque and angle are not known from markers alone."""
    sizes = [
        {"rms": rms, "per_marker": dict(each)}
        for rms, each in zip(finding.rms_mm, (finding.before, finding.after), strict=True)
    ]
    return UNKNOWN | {
        "verdict": finding.verdict,
        "complete": finding.complete,
        "left": {"marker_rms_mm": finding.rms_mm[1], "share": _share(finding), "wander": finding.wander},
        "causes": [_cause(cause) for cause in finding.causes],
        "candidates": [
            {
                "effect": one.tried.effect.name,
                "markers": list(one.tried.effect.markers),
                "gain": one.gain,
                "support": one.support,
            }
            for one in finding.candidates
        ],
        "confusable": [list(pair) for pair in finding.confusable],
        "next_experiment": finding.next_experiment,
        "before": UNKNOWN_ERRORS | {"marker_rms_mm": sizes[0]},
        "after": UNKNOWN_ERRORS | {"marker_rms_mm": sizes[1]},
        "gain": {"torque": None, "angle": None, "markers": finding.gain, "ci95": list(finding.ci95)},
        "residual": UNKNOWN_RESIDUAL | {"explained": finding.gain, "white": finding.complete},
    }


def _share(finding: MarkerFinding) -> float:
    was, now = finding.rms_mm
    return now / was if was > 0.0 else 0.0


def _cause(cause: NamedMarkerCause) -> Document:
    return {
        "effect": cause.effect,
        "markers": list(cause.markers),
        "parameters": {
            name: {"value": p.value, "std": p.std, "unit": p.unit} for name, p in cause.parameters.items()
        },
        "support": cause.support,
        "takes_away": dict(cause.takes_away),
        **({"trials": list(cause.trials)} if cause.trials else {}),
    }


def described(cause: NamedMarkerCause) -> str:
    """Return a cause in plain words, with its size."""
    where = ", ".join(cause.markers)
    numbers = ", ".join(f"{name} {_said(p)}" for name, p in cause.parameters.items())
    trials = f" in {', '.join(cause.trials)}" if cause.trials else ""
    size = f" ({numbers})" if numbers else ""
    return f"{cause.effect}, {where}: {catalogue()[cause.effect].sentence}{trials}{size}"


def _said(number: MarkerNumber) -> str:
    return f"{with_interval(number.value, math.nan if number.std is None else number.std)} {number.unit}".strip()
