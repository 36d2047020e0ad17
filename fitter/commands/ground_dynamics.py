"""`fitter dynamics --ground`: a person's masses from measured ground forces, without torque."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.progress import track as progress

from arm.arm_file import save_arm
from arm.body.limbs import BODY, LIMBS
from arm.model import Arm, Body
from fitter.commands.ground_said import say_ground
from fitter.commands.options import height_m, mass_kg
from fitter.commands.trial_sets import notes_of, with_notes
from fitter.data.trial import Trial
from fitter.ground.fit_corner import fit_corner_hz
from fitter.ground.floating_base import FloatingBase, floating_base
from fitter.ground.ground_document import document
from fitter.ground.ground_dynamics import learn_from_ground
from fitter.ground.ground_score import ground_score, worse_than_nothing
from fitter.ground.ground_trial import GroundTrial, ground_trial
from fitter.ground.link_names import link_named, link_names
from fitter.ground.measured_contact import measured_stretches, unmeasured
from limbcal.command import Document, console, say_notes, show
from limbcal.errors import ConfigError, Unusable
from limbcal.note import Note, of_source

_Read = Callable[[argparse.Namespace, Arm], tuple[list[Trial], list[Trial]]]
#: What learns from torque, and means nothing here.
_NOT_HERE: tuple[tuple[str, object], ...] = (
    ("no_torque", False), ("unknown_gains", False), ("fix", None), ("bounds", None), ("dask", None), ("workers",
    1), ("compare", []), ("payload", None),
)  # fmt: skip


def add_ground(parser: argparse.ArgumentParser) -> None:
    """Add what learning from the ground's forces needs."""
    group = parser.add_argument_group("a person, from measured ground forces instead of torque")
    group.add_argument(
        "--ground",
        nargs="+",
        type=Path,
        default=[],
        metavar="FORCES",
        help="one C3D, MOT or STO a trial: those learnt from in their order, then those of --evaluate",
    )
    group.add_argument(
        "--prior",
        choices=["regression"],
        help="the links are a table's for [body], with its spread: what the ground does not tell stays there",
    )
    group.add_argument(
        "--contact",
        action="append",
        default=[],
        metavar="PLATE=LINK",
        help="on which link a plate's force acts (as its place has it)",
    )
    group.add_argument("--mass", type=mass_kg, metavar="KG", help="whose prior it is, where the arm has no [body]")
    group.add_argument("--height", type=height_m, metavar="M")
    group.add_argument("--sex", choices=["f", "m"])


def ground_dynamics(arguments: argparse.Namespace, arm: Arm, read: _Read) -> Document:
    """Learn a person's masses, evaluate, and write the calibrated arm.

    Parameters
    ----------
    arguments : argparse.Namespace
    arm : Arm
    read : callable
        Reads the learning and the evaluating trials.
    """
    _check(arguments)
    arm = _of_person(arguments, arm)
    base = floating_base(arm)
    learn, evaluate = read(arguments, arm)
    n = len(learn) + len(evaluate)
    if len(arguments.ground) != n:
        raise ConfigError(
            f"--ground has {len(arguments.ground)} files for {n} trials, expected one a trial: those learnt from "
            f"in their order, then those of --evaluate"
        )
    names, given = link_names(arm), [link_named(text, arm) for text in arguments.contact]
    pairs = zip((*learn, *evaluate), arguments.ground, strict=True)
    trials = [
        ground_trial(arm, base, trial, forces, given, names)
        for trial, forces in progress([*pairs], "plates", console=console, transient=True)
    ]
    notes = [*notes_of((*learn, *evaluate))]
    for trial in trials:
        notes += of_source(trial.notes, trial.name)
    say_notes(notes)
    learnt_from = trials[: len(learn)]
    _refuse([note for trial in learnt_from for note in _unmeasured(arm, base, trial, names)], notes)
    judged = _judged(arm, base, trials[len(learn) :], names, notes)
    band_hz = min(fit_corner_hz(learnt_from, base.links.ravel()), *(trial.band_hz for trial in learn))
    fit = learn_from_ground(arm, base, learnt_from, regression=arguments.prior is not None, band_hz=band_hz)
    scores = {
        role: ground_score(arm, base, some, fit.before, fit.values, fit.plates, band_hz) if some else None
        for role, some in (("learn", learnt_from), ("evaluate", judged))
    }
    worse = worse_than_nothing(base, scores)
    say_notes(worse)
    notes += worse
    save_arm(fit.arm, arguments.out)
    used = {trial.name: trial for trial in (*learnt_from, *judged)}
    answer = document(fit, scores, [*used.values()], names, prior=arguments.prior is not None)
    say_ground(fit, scores, names, prior=arguments.prior is not None)
    if arguments.report is not None:
        files = [*(Path(one) for one in (*arguments.learn, *arguments.evaluate)), *arguments.ground]
        from fitter.report.ground_page import write_ground_page

        write_ground_page(arguments.report, fit, scores, judged or learnt_from, names, files, notes)
        show(f"report: {arguments.report}")
    return with_notes(answer, notes)


def _check(arguments: argparse.Namespace) -> None:
    mistakes = [
        f"--{name.replace('_', '-')} is given, expected it only where torque is learnt from"
        for name, usual in _NOT_HERE
        if getattr(arguments, name) != usual
    ]
    if not arguments.ground:
        mistakes.append("--prior is given without --ground, expected the ground's forces that it is a prior to")
    if mistakes:
        raise ConfigError(mistakes)


def _of_person(arguments: argparse.Namespace, arm: Arm) -> Arm:
    person = (arguments.mass, arguments.height, arguments.sex)
    if all(value is not None for value in person):
        preset = arm.name if arm.name in LIMBS else BODY
        return replace(arm, body=Body(preset if arm.body is None else arm.body.preset, *person))
    if any(value is not None for value in person):
        raise ConfigError("--mass, --height and --sex belong together, expected all three or none")
    if arguments.prior is not None and arm.body is None:
        raise ConfigError(f"arm {arm.name!r} has no [body], expected --mass, --height and --sex for --prior")
    return arm


def _judged(
    arm: Arm, base: FloatingBase, trials: Sequence[GroundTrial], names: Sequence[str], notes: list[Note]
) -> list[GroundTrial]:
    """Return what bodies are judged by: every trial, or its stretches in which all contact is measured.

    Adds to ``notes`` what was left out.
    """
    judged: list[GroundTrial] = []
    refused: list[Note] = []
    for trial in trials:
        found = _unmeasured(arm, base, trial, names)
        parts = measured_stretches(arm, base, trial, names) if found else [trial]
        judged += parts
        if not parts:
            refused += found
        elif found:
            seconds = trial.dt_s * np.array([sum(len(part.t) for part in parts), len(trial.t)])
            judgement = f"judged in the {seconds[0]:.1f} of {seconds[1]:.1f} s in which all contact is measured"
            more = [
                replace(found[0], text=f"{found[0].text}; {judgement}"),
                *of_source(parts[0].shift.notes, trial.name),
            ]
            say_notes(more)
            notes += more
    _refuse(refused, notes)
    return judged


def _unmeasured(arm: Arm, base: FloatingBase, trial: GroundTrial, names: Sequence[str]) -> list[Note]:
    return [*of_source(unmeasured(arm, base, trial, names), trial.name)]


def _refuse(found: Sequence[Note], notes: Sequence[Note]) -> None:
    """Refuse contact that no plate measures: it would be learnt as mass, or judged as an error of masses."""
    if found:
        sentences = [f"unmeasured_contact: {note.sentence}{_when(note)}" for note in found]
        raise Unusable(sentences, with_notes({}, [*notes, *found]))


def _when(note: Note) -> str:
    return "" if note.from_s is None or note.to_s is None else f" (from {note.from_s:.2f} to {note.to_s:.2f} s)"
