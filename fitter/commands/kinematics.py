"""`fitter kinematics`: angles and a measured tip, or a person's markers, to the geometry of eq. (1) to (3)."""

import argparse
from pathlib import Path
from typing import Literal

import numpy as np
from rich.progress import Progress

from arm.arm_file import load_arm, save_arm
from arm.model import Arm
from fitter.commands.arm_option import questioned_arm
from fitter.commands.limb_kinematics import add_body, limb_kinematics, require_no_limb
from fitter.commands.options import (
    add_arm,
    add_as_tracked,
    add_columns,
    add_out,
    add_report,
    add_search,
    bounds_of,
    fixed_of,
    joint_values,
    make_room,
)
from fitter.commands.trial_sets import notes_of, trial_sets, with_notes
from fitter.data.measured_tip import with_measured_tip
from fitter.data.trial import Trial
from fitter.kinematics.geometry_fit import GENERATIONS, LEAST_EXPLAINED, fit_kinematics, hardly
from fitter.kinematics.kinematics_fit import KinematicsFit, angle_noise_deg, document, gauge_sentences
from fitter.kinematics.tip_error import TipScore, tip_score
from fitter.report.compared import geometry_by_name
from fitter.report.parameter_table import parameter_table
from limbcal.command import Document, console, say, say_notes, show
from limbcal.errors import ConfigError, Unusable
from limbcal.note import sentences
from protocol.tables.files import expand

#: As it stands in the help.
EXAMPLE = "fitter kinematics recordings/run.mcap --arm my-arm.toml --out geometry.toml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Say what `fitter kinematics` takes."""
    parser.add_argument(
        "data",
        nargs="+",
        type=Path,
        metavar="DATA",
        help="trials with q1… and tipx tipy tipz, or recordings; with --body C3D or TRC",
    )
    parser.add_argument(
        "--evaluate", nargs="+", type=Path, default=[], metavar="EVAL", help="trials not learnt from"
    )
    add_arm(parser, required=False)
    add_body(parser)
    add_columns(parser)
    add_as_tracked(parser)
    add_search(parser, "100, or 8 a parameter", GENERATIONS)
    parser.add_argument("--bounds", metavar="P=LOW:HIGH,…", help="where to search (a in 0..1 m, angles ±30°)")
    parser.add_argument("--fix", metavar="P=VALUE,…", help="parameters that are known")
    parser.add_argument(
        "--free", metavar="P,…", default="", help="parameters to search that are left out by default"
    )
    parser.add_argument(
        "--about",
        choices=["auto", "rest", "mean"],
        default="auto",
        help="count displacements from the rest at the start (dead reckoning) or from their mean (a tracker); "
        "auto: the rest, where there is one that stands out from noise",
    )
    parser.add_argument(
        "--angle-noise-deg",
        metavar="auto|S|S1,S2,…",
        default="auto",
        help="standard deviation of white noise in the angles (mm where a joint slides), which is undone; 0: none "
        "(auto: estimated)",
    )
    parser.add_argument("--compare", action="append", default=[], metavar="A", help="another arm to print beside")
    add_out(parser, "the arm with the geometry found, as an arm file")
    add_report(parser)
    parser.set_defaults(action=kinematics)


def kinematics(arguments: argparse.Namespace) -> Document:
    """Learn the geometry and write the arm."""
    if arguments.body is not None:
        return limb_kinematics(arguments)
    if arguments.arm is None:
        raise ConfigError("--arm is missing, expected an arm file or a built-in arm; for a person's limb --body")
    require_no_limb(arguments)
    arm = questioned_arm(arguments.arm)
    compared = {Path(source).stem: geometry_by_name(load_arm(source)) for source in arguments.compare}
    learn, evaluate = _trials(arguments, arm)
    make_room(arguments.out, read=[*arguments.data, *arguments.evaluate])
    if arguments.report is not None:
        make_room(arguments.report, (".html",))
    angle_noise = angle_noise_of(arguments.angle_noise_deg, arm)
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
            about=arguments.about,
            angle_noise=angle_noise,
            progress=lambda done, _rms: progress.update(task, completed=done),
        )
    learnt = tip_score(fit.arm, learn, fit.about)
    evaluated = tip_score(fit.arm, evaluate, fit.about) if evaluate else None
    save_arm(fit.arm, arguments.out)
    _print(fit, compared, learnt, evaluated)
    answer = with_notes(document(fit, learnt, evaluated), notes_of((*learn, *evaluate)))
    if compared:
        answer["compared"] = compared
    if arguments.report is not None:
        files = expand([*arguments.data, *arguments.evaluate])
        from fitter.report.fit_pages import kinematics_page

        kinematics_page(fit, answer, learn, evaluate, compared, [arguments.arm, *files]).write(arguments.report)
        show(f"report: {arguments.report}")
    reasons = [
        f"{title}: {hardly(s.explained)}"
        for title, s in (("learning trials", learnt), ("evaluating trials", evaluated))
        if s is not None and s.explained < LEAST_EXPLAINED
    ]
    if reasons:
        raise Unusable(reasons, answer)
    return answer


def angle_noise_of(text: str, arm: Arm) -> Literal["auto"] | None | list[float]:
    """Read ``--angle-noise-deg``: one number for all joints, or one each.

    Raises
    ------
    ConfigError
        If it is neither ``auto`` nor numbers that are not below zero.
    """
    if text == "auto":
        return "auto"
    values = joint_values(text if "," in text else ",".join([text] * arm.n_joint), arm, "--angle-noise-deg")
    if np.any(values < 0.0):
        raise ConfigError(f"--angle-noise-deg is {text!r}, expected numbers that are not below 0")
    if not np.any(values):
        return None
    turns = np.array([joint.type == "revolute" for joint in arm.joints])
    return [float(value) for value in np.where(turns, np.deg2rad(values), 1e-3 * values)]


def _trials(arguments: argparse.Namespace, arm: Arm) -> tuple[list[Trial], list[Trial]]:
    learn, evaluate = trial_sets(arguments, arm, arguments.data, (np.inf, None))
    say_notes(notes_of((*learn, *evaluate)))
    with_tip = [[with_measured_tip(arm, trial) for trial in trials] for trials in (learn, evaluate)]
    return with_tip[0], with_tip[1]


def _print(
    fit: KinematicsFit, compared: dict[str, dict[str, float]], learn: TipScore, evaluate: TipScore | None
) -> None:
    title = f"{fit.arm.name}: {fit.samples} samples, {fit.generations} generations"
    show(parameter_table(title, fit.parameters, compared))
    show(f"displacements counted from the {'rest at the start' if fit.about == 'rest' else 'mean'}")
    show(_noise_in_words(fit))
    for sentence in (*sentences(fit.notes), *gauge_sentences(fit)):
        say(sentence)
    for role, s in (("learning", learn), ("evaluating", evaluate)):
        if s is not None:
            share = f"{100.0 * s.explained:.4g} % of its power explained"
            show(f"{role}: tip displacement off by {s.mean_mm:.3g} mm mean, {s.max_mm:.3g} mm max, {share}")


def _noise_in_words(fit: KinematicsFit) -> str:
    noise = [value for value in angle_noise_deg(fit) if value is not None]
    if not noise or fit.angle_noise_source is None:
        return "noise of the angles: not identified by this data, and not undone"
    how = {
        "known": "as given",
        "spectrum": "the floor of the angles' spectra",
        "moments": "estimated together with the geometry",
    }[fit.angle_noise_source]
    units = ["°" if joint.type == "revolute" else " mm" for joint in fit.arm.joints]
    sizes = ", ".join(f"{value:.3g}{unit}" for value, unit in zip(noise, units, strict=True))
    return f"noise of the angles: {sizes} ({how})"
