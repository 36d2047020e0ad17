"""`fitter kinematics`: joint angles and a measured tip to the arm's geometry, eq. (1) to (3)."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from rich.progress import Progress

from arm.arm_file import load_arm, save_arm
from arm.model import Arm
from fitter.commands.options import (
    add_arm,
    add_columns,
    add_out,
    add_search,
    bounds_of,
    fixed_of,
    make_room,
)
from fitter.commands.trial_sets import trial_sets
from fitter.data.measured_tip import with_measured_tip
from fitter.data.trials import Role, Trial, load_trials
from fitter.kinematics.evaluation import TipScore, tip_score
from fitter.kinematics.fit import GENERATIONS, KinematicsFit, document, fit_kinematics
from fitter.report.compared import geometry_by_name
from fitter.report.parameter_table import parameter_table
from limbcal.command import Document, console, say


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter kinematics` takes."""
    parser.add_argument(
        "data", nargs="+", type=Path, metavar="DATA", help="trials with q1… and tipx tipy tipz, or recordings"
    )
    parser.add_argument(
        "--evaluate", nargs="+", type=Path, default=[], metavar="EVAL", help="trials not learnt from"
    )
    add_arm(parser)
    add_columns(parser)
    add_search(parser, "100, or 8 a parameter", GENERATIONS)
    parser.add_argument("--bounds", metavar="P=LOW:HIGH,…", help="where to search (a in 0..1 m, angles ±30°)")
    parser.add_argument("--fix", metavar="P=VALUE,…", help="parameters that are known")
    parser.add_argument(
        "--free", metavar="P,…", default="", help="parameters to search that are left out by default"
    )
    parser.add_argument(
        "--about",
        choices=["rest", "mean"],
        default="rest",
        help="count displacements from the rest at the start (dead reckoning) or from their mean (a tracker)",
    )
    parser.add_argument("--compare", action="append", default=[], metavar="A", help="another arm to print beside")
    add_out(parser, "the arm with the geometry found, as an arm file")
    parser.set_defaults(action=kinematics)


def kinematics(arguments: argparse.Namespace) -> Document:
    """Learn the geometry and write the arm."""
    arm = load_arm(arguments.arm)
    compared = {Path(source).stem: geometry_by_name(load_arm(source)) for source in arguments.compare}
    learn, evaluate = _trials(arguments, arm)
    make_room(arguments.out)
    about: Literal["rest", "mean"] = "mean" if arguments.about == "mean" else "rest"
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("searching", total=arguments.generations)
        fit = fit_kinematics(
            arm,
            learn,
            seed=arguments.seed,
            population=arguments.population,
            generations=arguments.generations,
            bounds=bounds_of(arguments.bounds),
            fixed=fixed_of(arguments.fix),
            free=[name for name in arguments.free.split(",") if name],
            about=about,
            progress=lambda done, _rms: progress.update(task, completed=done),
        )
    learnt = tip_score(fit.arm, learn, about)
    evaluated = tip_score(fit.arm, evaluate, about) if evaluate else None
    save_arm(fit.arm, arguments.out)
    _print(fit, compared, learnt, evaluated)
    answer = document(fit, learnt, evaluated)
    if compared:
        answer["compared"] = compared
    return answer


def _trials(arguments: argparse.Namespace, arm: Arm) -> tuple[list[Trial], list[Trial]]:
    def load(
        sources: Sequence[Path], role: Role | None, _filters: tuple[float, float] | None
    ) -> list[Trial]:
        return load_trials(
            sources, arm.n_joint, arguments.columns, rate_hz=arguments.rate_hz, cutoff_hz=np.inf, role=role
        )

    learn, evaluate = trial_sets(load, arguments.data, arguments.evaluate)
    for trial in (*learn, *evaluate):
        for note in trial.notes:
            say(f"{trial.name}: {note}")
    with_tip = [[with_measured_tip(arm, trial) for trial in trials] for trials in (learn, evaluate)]
    return with_tip[0], with_tip[1]


def _print(
    fit: KinematicsFit, compared: dict[str, dict[str, float]], learn: TipScore, evaluate: TipScore | None
) -> None:
    title = f"{fit.arm.name}: {fit.samples} samples, {fit.generations} generations"
    console.print(parameter_table(title, fit.parameters, compared))
    for role, s in (("learning", learn), ("evaluating", evaluate)):
        if s is not None:
            say(f"{role}: tip displacement off by {s.mean_mm:.3g} mm mean, {s.max_mm:.3g} mm max")
