"""`fitter dynamics`: torque and motion to dynamic parameters, eq. (4), (8), (9)."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.progress import Progress

from arm.arm_file import load_arm, save_arm
from arm.model import Arm, Control
from fitter.commands.options import (
    add_arm,
    add_columns,
    add_out,
    add_search,
    bounds_of,
    fixed_of,
    make_room,
    positive,
)
from fitter.commands.trial_sets import trial_sets
from fitter.data.sources import RECORDINGS, expand
from fitter.data.trials import Role, Trial, load_trials, undriven
from fitter.dynamics.dynamics_fit import DynamicsFit, Objective, document
from fitter.dynamics.evaluation import HORIZON_S, Score, score
from fitter.dynamics.fit import fit_dynamics
from fitter.dynamics.torque_search import GENERATIONS
from fitter.report.compared import Compared, load_compared
from fitter.report.parameter_table import parameter_table
from limbcal.command import Document, console, say


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter dynamics` takes."""
    parser.add_argument(
        "learn", nargs="+", type=Path, metavar="LEARN", help="trials to learn from: files, folders"
    )
    parser.add_argument(
        "--evaluate", nargs="+", type=Path, default=[], metavar="EVAL", help="trials not learnt from"
    )
    add_arm(parser)
    add_columns(parser)
    parser.add_argument("--cutoff-hz", type=positive, metavar="F", help="corner of the fit (found in the data)")
    add_search(parser, "100, or 8 a parameter", GENERATIONS)
    parser.add_argument("--method", choices=["ga", "least-squares"], default="ga")
    parser.add_argument(
        "--objective",
        choices=["auto", "torque", "weighted", "robust", "motion"],
        default="auto",
        help="what is made small: eq. (9); with joints weighted by their noise; with outliers drawn in as well; "
        "the error of the simulated motion (auto: motion under a control law, torque where that is measured)",
    )
    parser.add_argument(
        "--physical", action="store_true", help="only masses that can exist, and friction that brakes"
    )
    parser.add_argument(
        "--no-torque",
        action="store_true",
        help="nothing drove the arm; one mass, moment or inertia must be given by --fix",
    )
    parser.add_argument("--bounds", metavar="P=LOW:HIGH,…", help="where to search (wide, from the torque's size)")
    parser.add_argument("--fix", metavar="P=VALUE,…", help="parameters that are known")
    parser.add_argument(
        "--horizon",
        type=positive,
        default=HORIZON_S,
        metavar="S",
        help=f"restart of simulations ({HORIZON_S}) [s]",
    )
    parser.add_argument("--compare", action="append", default=[], metavar="A", help="another arm to print beside")
    add_out(parser, "the calibrated arm, as an arm file")
    parser.set_defaults(action=dynamics)


def dynamics(arguments: argparse.Namespace) -> Document:
    """Learn, evaluate, and write the calibrated arm."""
    arm = load_arm(arguments.arm)
    compared = load_compared(arguments.compare, arm)
    learn, evaluate = _trials(arguments, arm)
    if arguments.no_torque:
        arm = replace(arm, control=Control())
        learn, evaluate = ([undriven(trial) for trial in trials] for trials in (learn, evaluate))
    make_room(arguments.out)
    for trial in (*learn, *evaluate):
        for note in trial.notes:
            say(f"{trial.name}: {note}")
    fit = _fit(arguments, arm, learn)
    learnt = score(fit.arm, learn, arguments.horizon)
    evaluated = score(fit.arm, evaluate, arguments.horizon) if evaluate else None
    save_arm(fit.arm, arguments.out)
    _print(fit, compared, learnt, evaluated)
    answer = document(fit, learnt, evaluated)
    if compared:
        answer["compared"] = {c.name: c.document(learn, evaluate, arguments.horizon) for c in compared}
        _print_compared(answer["compared"])
    return answer


def _fit(arguments: argparse.Namespace, arm: Arm, learn: Sequence[Trial]) -> DynamicsFit:
    objective: Objective = arguments.objective
    if arguments.objective == "auto":
        objective = "torque" if arm.control.law == "measured" else "motion"
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("searching", total=arguments.generations)
        polish = progress.add_task("fitting the motion", total=None, visible=False)
        fit = fit_dynamics(
            arm,
            learn,
            objective=objective,
            seed=arguments.seed,
            population=arguments.population,
            generations=arguments.generations,
            bounds=bounds_of(arguments.bounds),
            fixed=fixed_of(arguments.fix),
            method=arguments.method,
            window_s=arguments.horizon,
            physical=arguments.physical,
            progress=lambda done, _cost: progress.update(task, completed=done),
            polishing=lambda done, _rms: progress.update(polish, completed=done, visible=True),
        )
    return fit


def _trials(arguments: argparse.Namespace, arm: Arm) -> tuple[list[Trial], list[Trial]]:
    corner_hz: float | None = arguments.cutoff_hz
    if corner_hz is None and all(path.suffix.lower() in RECORDINGS for path in expand(arguments.learn)):
        corner_hz = np.inf  # a tracker's motion is smooth already, and is learnt from as it was when it was live

    def load(
        sources: Sequence[Path], role: Role | None, filters: tuple[float, float] | None
    ) -> list[Trial]:
        cutoff_hz, band_hz = filters or (corner_hz, None)
        return load_trials(
            sources,
            arm.n_joint,
            arguments.columns,
            rate_hz=arguments.rate_hz,
            cutoff_hz=cutoff_hz,
            band_hz=band_hz,
            role=role,
        )

    return trial_sets(load, arguments.learn, arguments.evaluate)


def _print(fit: DynamicsFit, compared: list[Compared], learn: Score, evaluate: Score | None) -> None:
    title = f"{fit.arm.name}: {fit.samples} samples, condition {fit.condition_number:.3g}"
    console.print(parameter_table(title, fit.parameters, {c.name: c.parameters for c in compared}))
    for role, s in (("learning", learn), ("evaluating", evaluate)):
        if s is not None:
            torque = ", ".join(f"{value:.4g}" for value in s.torque_rms_N_m)
            say(
                f"{role}: torque rms {torque} N·m a joint; simulated angle off by "
                f"{s.angle_mean_deg:.3g}° mean, {s.angle_max_deg:.3g}° max"
            )
    for note in fit.notes:
        say(note)


def _print_compared(compared: object) -> None:
    assert isinstance(compared, dict)
    for name, fields in compared.items():
        for role, title in (("learn", "learning"), ("evaluate", "evaluating")):
            torque = fields["torque_rms_N_m"][role]
            if torque is not None:
                said = ", ".join(f"{value:.4g}" for value in torque)
                say(f"{name}, {title}: torque rms {said} N·m a joint")
