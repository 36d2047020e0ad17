"""`fitter diagnose`: what the simulation gets wrong, why, and the gain of putting it right."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from rich.markup import escape
from rich.progress import Progress
from rich.table import Table

from arm.effects.catalogue import catalogue
from arm.model import Arm
from arm.structural_parameters import structural_parameters
from fitter.commands.arm_option import questioned_arm
from fitter.commands.diagnose_markers import diagnose_marker_files
from fitter.commands.diagnose_readings import diagnose_readings, readings
from fitter.commands.diagnosis_sets import TrialSet, add_sets, require_other_samples, sets_of
from fitter.commands.limb_track import has_markers
from fitter.commands.options import add_arm, add_as_tracked, add_columns, positive
from fitter.commands.trial_sets import notes_of
from fitter.data.motions import Measured
from fitter.data.trials import to_trials
from fitter.diagnosis.diagnosis import diagnose
from fitter.diagnosis.finding import UNKNOWN, Finding, NamedCause
from fitter.diagnosis.held_out_error import Errors
from fitter.dynamics.evaluation import HORIZON_S
from fitter.dynamics.found_targets import HINT, lacks_torque, with_found_targets
from fitter.dynamics.torque_wiring import check_wiring
from fitter.report.diagnosis_errors import BY_NAME, by_name_rows, error_rows
from fitter.report.diagnosis_words import trial_offsets
from limbcal.command import Document, console, say, show, to_json, with_asked
from limbcal.digits import with_interval
from limbcal.errors import ConfigError, DeviceError, Unusable
from limbcal.note import Note, documents
from limbcal.suggestion import did_you_mean

#: What the base model can be denied, and how its parameters' names begin.
_DENIABLE = {"viscous": "D", "coulomb": "fc"}

#: As it stands in the help.
EXAMPLE = "fitter diagnose recordings/run.mcap --arm my-arm.toml --out diagnosis"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter diagnose` takes."""
    parser.add_argument("learn", nargs="+", type=Path, metavar="LEARN", help="trials to learn from")
    add_sets(parser)
    add_arm(parser)
    add_columns(parser)
    add_as_tracked(parser)
    parser.add_argument(
        "--deny", metavar="LIST", help="frictions that the base model is to do without: viscous,coulomb"
    )
    parser.add_argument(
        "--horizon",
        type=positive,
        default=HORIZON_S,
        metavar="S",
        help=f"with measured or no torque a simulation begins anew from the data so often ({HORIZON_S:g} s)",
    )
    parser.add_argument("--no-torque", action="store_true", help="nothing drives the arm: it swings freely")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="report, JSON, pictures, extended arm"
    )
    parser.set_defaults(action=diagnose_command)


def diagnose_command(arguments: argparse.Namespace) -> Document:
    """Diagnose, write everything, and say it."""
    arm = questioned_arm(arguments.arm)
    denied = _denied(arguments.deny)
    try:
        arguments.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DeviceError(f"{arguments.out}: cannot be made: {error.strerror}") from error
    if has_markers([*arguments.learn, *arguments.evaluate]):
        return diagnose_marker_files(arm, arguments)
    sets = sets_of(arguments)
    raw = [readings(one.sources, arm, one.columns, arguments.rate_hz) if one.sources else None for one in sets[:2]]
    if raw[0] is not None and not arguments.evaluate:
        raise ConfigError("--evaluate is missing; expected readings to judge on, other than those to learn from")
    if raw[0] is not None and arguments.judge:
        raise ConfigError("--judge takes joint motion, expected none beside readings of accelerometers")
    if raw[0] is not None and raw[1] is not None:
        return diagnose_readings(arm, raw[0], raw[1], arguments.out)
    learn, evaluate, judge = _trial_sets(arm, arguments, sets)
    given = [*learn, *evaluate, *(motion for some in judge.values() for motion in some)]
    if not arguments.no_torque and any(lacks_torque(arm, motion) for motion in given):
        say(HINT)
        judge = {name: with_found_targets(arm, learn, some)[1] for name, some in judge.items()}
        learn, evaluate = with_found_targets(arm, learn, evaluate)
    if not arguments.no_torque:
        _require_possible(arm, learn, arguments)
    # No thread of the bar's own: work is shared with forked processes (`fitter.parallel`).
    with Progress(console=console, transient=True, auto_refresh=False) as progress:
        task = progress.add_task("reading", total=1.0)
        found = diagnose(
            arm,
            learn,
            evaluate,
            rate_hz=arguments.rate_hz,
            denied=denied,
            free=arguments.no_torque,
            horizon_s=arguments.horizon,
            judge=judge,
            progress=lambda what, done: progress.update(task, description=what, completed=done, refresh=True),
        )
    out: Path = arguments.out
    from fitter.report.diagnosis_report import write_diagnosis

    write_diagnosis(found, out)
    _say(found.finding, out)
    return found.finding.document()


def _require_possible(arm: Arm, learn: Sequence[Measured], arguments: argparse.Namespace) -> None:
    """Refuse torque columns that are wired wrongly: whatever causes they have, no arm moves so.

    Raises
    ------
    Unusable
        If another way of wiring them leaves far less.
    """
    if arm.control.law != "measured" or any("tau" not in motion.columns for motion in learn):
        return
    trials = to_trials(learn, arguments.rate_hz)
    check = check_wiring(arm, structural_parameters(arm), trials)
    if check is None or check.better is None:
        return
    answer: Document = UNKNOWN | {
        "verdict": "unexplained",
        "complete": False,
        "left": None,
        "causes": [],
        "candidates": [],
        "confusable": [],
        "next_experiment": check.better.sentence,
        "before": None,
        "after": None,
        "gain": None,
        "notes": documents([*notes_of(trials), Note("impossible", check.better.sentence)]),
    }
    answer = with_asked(answer)
    path: Path = arguments.out / "diagnosis.json"
    try:
        path.write_text(to_json(answer), encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{path}: cannot be written: {error.strerror}") from error
    raise Unusable(check.better.sentence, answer)


def _trial_sets(
    arm: Arm, arguments: argparse.Namespace, sets: tuple[TrialSet, TrialSet, TrialSet]
) -> tuple[list[Measured], list[Measured], dict[str, list[Measured]]]:
    """Read all sets; without ``--evaluate`` a recording's own roles separate learning and evaluating trials."""
    judge = {str(one): sets[2].only(one).read(arm, arguments.rate_hz) for one in sets[2].sources}
    read = [one.read(arm, arguments.rate_hz) for one in sets[:2]]
    unseen = [motion for some in judge.values() for motion in some]
    require_other_samples(list(zip(sets, [*read, unseen], strict=True)))
    trials, held_back = read
    if arguments.evaluate:
        return trials, held_back, judge
    held_back = [trial for trial in trials if trial.role == "evaluate"]
    if not held_back:
        raise ConfigError(
            f"--evaluate is missing, and {trials[0].where} marks no trial as evaluating; "
            "expected trials to judge on"
        )
    return [trial for trial in trials if trial.role != "evaluate"], held_back, judge


def _denied(text: str | None) -> tuple[str, ...]:
    names = [part.strip() for part in (text or "").split(",") if part.strip()]
    for name in names:
        if name not in _DENIABLE:
            meant = did_you_mean(name, _DENIABLE)
            raise ConfigError(f"--deny is {text!r}, expected some of {', '.join(_DENIABLE)}{meant}")
    return tuple(_DENIABLE[name] for name in names)


def _say(finding: Finding, out: Path) -> None:
    sentences = {
        "named": "The simulation is wrong, and this is why:",
        "ambiguous": "The simulation is wrong; these explain it equally well:",
        "none": "Nothing above the noise: the simulation is as good as the data.",
        "unexplained": "The simulation is wrong, and no effect of the catalogue explains it.",
    }
    show(sentences[finding.verdict])
    for cause in finding.causes:
        show(f"  {described(cause)}")
    for warning in finding.warnings:
        show(f"but {warning.text}")
    if finding.discrepancy.depends_on:
        variables, formula = ", ".join(finding.discrepancy.depends_on), finding.discrepancy.formula
        show(f"the residual depends on {variables} {formula}".strip())
    if constant := trial_offsets(finding.discrepancy.trial_offsets_N_m, finding.arm):
        show(constant)
    if finding.polish is not None:
        show(finding.polish.sentence)
    _show_errors("on the evaluating trials", finding.arm, (finding.before, finding.after))
    if finding.judged is not None:
        _show_errors("on the trials that had no say", finding.arm, (finding.judged.before, finding.judged.after))
        table = Table(*map(escape, ("set", *BY_NAME)))
        for row in by_name_rows(finding.judged.by_set()):
            table.add_row(*map(escape, row))
        show(table)
    show(f"next: {finding.next_experiment}")
    show(f"report: {out / 'report.html'}")


def _show_errors(where: str, arm: Arm, models: Sequence[Errors]) -> None:
    table = Table(where, "before", "after")
    for row in error_rows(arm, models):
        table.add_row(*map(escape, row))
    show(table)


def described(cause: NamedCause) -> str:
    """Return a cause in plain words, with its size."""
    where = "".join(f", joint {j}" for j in cause.joints)
    said = {name: f"{with_interval(p.value, p.std)} {p.unit}".strip() for name, p in cause.parameters.items()}
    numbers = ", ".join(f"{name} {size}" for name, size in said.items())
    more = "".join(f", {name} {value}" for name, value in cause.where.items())
    return f"{cause.effect}{where}: {catalogue()[cause.effect].sentence} ({numbers}{more})"
