"""`fitter dynamics`: torque and motion to dynamic parameters, eq. (4), (8), (9)."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.progress import Progress

from arm.model import Arm, Control
from arm.structural_parameters import structural_parameters
from fitter.commands.arm_option import questioned_arm
from fitter.commands.dynamics_said import say_compared, say_controller, say_fit, say_ratios
from fitter.commands.equilibrium import nothing_is_known, up_to_scale
from fitter.commands.ground_dynamics import add_ground, ground_dynamics
from fitter.commands.options import (
    add_arm,
    add_as_tracked,
    add_columns,
    add_out,
    add_report,
    add_search,
    at_least,
    bounds_of,
    fixed_of,
    make_room,
    positive,
    require_heeded,
)
from fitter.commands.payload_option import add_payload, unloaded
from fitter.commands.summed_dynamics import dynamics_from_sums
from fitter.commands.trial_sets import notes_of, trial_sets, with_notes
from fitter.controller import controller
from fitter.data.torque_target import has_unknown_target
from fitter.data.trial import Trial, undriven
from fitter.dynamics.dynamics_fit import DynamicsFit, Objective, document
from fitter.dynamics.evaluation import HORIZON_S, score
from fitter.dynamics.fit import fit_dynamics
from fitter.dynamics.free_swing import swing_corner_hz, swing_ratios, swing_scale
from fitter.dynamics.identifiability import report
from fitter.dynamics.known_effects import taken_out_notes, without_effects
from fitter.dynamics.torque_delay import torque_delay
from fitter.dynamics.torque_search import GENERATIONS
from fitter.dynamics.usability import explained_of, joint_notes, next_to_nothing, unusable
from fitter.dynamics.written import determined_by_data, save_calibrated
from fitter.regression_sums.saved_sums import is_sums
from fitter.report.assumptions import dynamics_assumptions
from fitter.report.compared import Compared, load_compared, scores_document
from limbcal.command import Document, console, say_notes, show
from limbcal.errors import ConfigError, Unusable
from limbcal.note import Note
from protocol.tables.files import RECORDINGS, expand

#: As it stands in the help.
EXAMPLE = "fitter dynamics learn --evaluate held-back --arm my-arm.toml --out calibrated.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter dynamics` takes."""
    parser.add_argument(
        "learn", nargs="+", type=Path, metavar="LEARN", help="trials to learn from: files, folders, or their sums"
    )
    parser.add_argument(
        "--evaluate", nargs="+", type=Path, default=[], metavar="EVAL", help="trials not learnt from"
    )
    add_arm(parser)
    add_columns(parser)
    add_as_tracked(parser)
    parser.add_argument("--cutoff-hz", type=positive, metavar="F", help="corner of the fit (found in the data)")
    add_search(parser, "100, or 8 a parameter", GENERATIONS)
    parser.add_argument("--method", choices=["ga", "least-squares"], default="ga")
    parser.add_argument(
        "--objective",
        choices=["auto", "torque", "likelihood", "weighted", "robust", "motion"],
        default="auto",
        help="what is made small: eq. (9); with frequencies weighted by their noise; with joints weighted by "
        "theirs; with outliers drawn in as well; the error of the simulated motion (auto: motion where a law "
        "drives and angles alone were measured, torque for a tracker's motion, else likelihood)",
    )
    parser.add_argument(
        "--physical", action="store_true", help="only masses that can exist, and friction that brakes"
    )
    parser.add_argument(
        "--no-torque",
        action="store_true",
        help="nothing drove the arm: only ratios are known; a mass, moment or inertia given by --fix sets the "
        "scale (the last link's inertia in the arm file)",
    )
    parser.add_argument("--bounds", metavar="P=LOW:HIGH,…", help="where to search (wide, from the torque's size)")
    parser.add_argument("--fix", metavar="P=VALUE,…", help="parameters that are known")
    parser.add_argument(
        "--unknown-gains",
        action="store_true",
        help="learn the law's gains too; one number given by --fix (kp1, I2, …) sets the scale of all others; "
        "without a law, torque or target (a person): ratios alone, the equilibrium trajectory being free",
    )
    parser.add_argument("--workers", type=at_least(1), default=1, metavar="N", help="processes that reduce (1)")
    parser.add_argument("--dask", metavar="tcp://…", help="scheduler of a Dask cluster that reduces them instead")
    parser.add_argument(
        "--horizon",
        type=positive,
        default=HORIZON_S,
        metavar="S",
        help=f"restart of simulations ({HORIZON_S}) [s]",
    )
    parser.add_argument("--compare", action="append", default=[], metavar="A", help="another arm to print beside")
    add_out(parser, "the calibrated arm, as an arm file")
    add_report(parser)
    add_payload(parser)
    add_ground(parser)
    parser.set_defaults(action=dynamics)


def dynamics(arguments: argparse.Namespace) -> Document:
    """Learn, evaluate, and write the calibrated arm."""
    arm = questioned_arm(arguments.arm)
    make_room(arguments.out, read=[*arguments.learn, *arguments.evaluate, *arguments.ground])
    if arguments.report is not None:
        make_room(arguments.report, (".html",))
    if arguments.ground or arguments.prior is not None:
        return ground_dynamics(arguments, arm, _trials)
    if arguments.workers > 1 or arguments.dask or any(is_sums(path) for path in arguments.learn):
        return dynamics_from_sums(arguments, arm)
    if arguments.unknown_gains:
        unheeded: dict[str, object] = {
            "bounds": None,
            "physical": False,
            "objective": "auto",
            "compare": [],
            "payload": None,
        }
        require_heeded(arguments, "--unknown-gains", unheeded)
    compared = load_compared(arguments.compare, arm)
    learn, evaluate = _trials(arguments, arm)
    if arguments.no_torque:
        require_heeded(arguments, "--no-torque", {"payload": None})
        arm = replace(arm, control=Control())
        learn, evaluate = ([undriven(trial) for trial in trials] for trials in (learn, evaluate))
    notes, load = notes_of((*learn, *evaluate)), dict[str, object]()
    if arguments.payload is not None:
        learn, evaluate, load, gauged = unloaded(arguments.payload, arm, learn, evaluate)
        notes += tuple(gauged)
    say_notes(notes)
    if arguments.unknown_gains and nothing_is_known(arm, learn):
        return with_notes(up_to_scale(arguments, arm, learn), notes)
    if arguments.unknown_gains and arguments.report is not None:
        raise ConfigError("--report shows no gains; expected it without --unknown-gains")
    if arguments.unknown_gains:
        return with_notes(_with_gains(arguments, arm, learn, evaluate), notes)
    fit = _fit(arguments, arm, learn)
    evaluated = score(fit.arm, evaluate, arguments.horizon) if evaluate else None
    scores = {"learn": score(fit.arm, learn, arguments.horizon), "evaluate": evaluated}
    found = any(has_unknown_target(arm, trial) for trial in learn)
    assumed = dynamics_assumptions(arm, lengths_learnt=False, targets_found=found, driven=not arguments.no_torque)
    plain, bare = without_effects(arm, learn, fit.objective)
    late = torque_delay(plain, fit.base, bare)
    more = (*taken_out_notes(arm, plain), *joint_notes(scores), *([] if late is None else [late.note]))
    fit = replace(fit, notes=(*fit.notes, *more, *(Note("assumed", said) for said in assumed)))
    save_calibrated(fit.arm, fit.base, determined_by_data(fit), arguments.out)
    revealed = report(plain, fit.base, fit.problem)
    say_fit(fit, compared, scores["learn"], evaluated, revealed)
    answer = document(fit, scores["learn"], evaluated) | {"identifiability": revealed.document()}
    answer |= _free_swing(arguments, arm, learn) if arguments.no_torque else load
    if compared:
        answer["compared"] = {c.name: c.document(learn, evaluate, arguments.horizon) for c in compared}
        say_compared(arm, answer["compared"])
    reasons = unusable(fit, plain, bare, scores)
    if arguments.report is not None:
        _write_page(arguments, fit, answer, (learn, evaluate), compared, reasons)
    answer = with_notes(answer, notes)
    if reasons:
        raise Unusable(reasons, answer)
    return answer


def _write_page(
    arguments: argparse.Namespace,
    fit: DynamicsFit,
    answer: Document,
    trials: tuple[Sequence[Trial], Sequence[Trial]],
    compared: Sequence[Compared],
    reasons: Sequence[str],
) -> None:
    """Write the report: the trials to learn from and to evaluate on, what was learnt, why it is of no use."""
    from fitter.report.fit_pages import dynamics_page

    others = {c.name: c.parameters for c in compared}
    sources = [arguments.arm, *expand([*arguments.learn, *arguments.evaluate])]
    dynamics_page(fit, answer, *trials, others, sources, arguments.horizon, reasons).write(arguments.report)
    show(f"report: {arguments.report}")


def _free_swing(arguments: argparse.Namespace, arm: Arm, learn: Sequence[Trial]) -> Document:
    """Return what a free swing tells, and print it; unless a corner was given, by trials with a higher one."""
    corner_hz = swing_corner_hz(learn)
    if arguments.cutoff_hz is None and all(np.isfinite(trial.cutoff_hz) for trial in learn):
        given = argparse.Namespace(**{**vars(arguments), "cutoff_hz": corner_hz, "evaluate": []})
        learn = [undriven(trial) for trial in _trials(given, arm)[0]]
    arm, learn = without_effects(arm, learn)
    swing = swing_ratios(arm, learn)
    say_ratios(swing)
    return swing.document()


def _fit(arguments: argparse.Namespace, arm: Arm, learn: Sequence[Trial]) -> DynamicsFit:
    free = swing_scale(arm) if arguments.no_torque else {}
    objective: Objective | None = None if arguments.objective == "auto" else arguments.objective
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("searching", total=arguments.generations)
        polish = progress.add_task("fitting the motion", total=None, visible=False)
        return fit_dynamics(
            arm,
            learn,
            objective=objective,
            seed=arguments.seed,
            population=arguments.population,
            generations=arguments.generations,
            bounds=bounds_of(arguments.bounds),
            fixed=fixed_of(arguments.fix) or free,
            method=arguments.method,
            window_s=arguments.horizon,
            physical=arguments.physical,
            progress=lambda done, _cost: progress.update(task, completed=done),
            polishing=lambda done, _rms: progress.update(polish, completed=done, visible=True),
        )


def _with_gains(
    arguments: argparse.Namespace, arm: Arm, learn: Sequence[Trial], evaluate: Sequence[Trial]
) -> Document:
    """Learn the gains of the law along with the arm."""
    found = controller.fit_controller(arm, learn, fixed=fixed_of(arguments.fix))
    base = structural_parameters(arm)
    identifiable = {name: found.parameters[name] for name in base.names if found.parameters[name].identifiable}
    save_calibrated(found.arm, base, identifiable, arguments.out)
    scores = {
        role: score(found.arm, trials, arguments.horizon) if trials else None
        for role, trials in (("learn", learn), ("evaluate", evaluate))
    }
    say_controller(found, scores)
    answer = controller.document(found) | scores_document(scores)
    if reasons := next_to_nothing(explained_of(scores), found.arm):
        raise Unusable(reasons, answer)
    return answer


def _trials(arguments: argparse.Namespace, arm: Arm) -> tuple[list[Trial], list[Trial]]:
    corner_hz: float | None = arguments.cutoff_hz
    if corner_hz is None and all(path.suffix.lower() in RECORDINGS for path in expand(arguments.learn)):
        corner_hz = np.inf  # a tracker's motion is smooth already
    return trial_sets(arguments, arm, arguments.learn, (corner_hz, None))
