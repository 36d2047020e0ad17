"""The trials to learn from and those held back: never mixed."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from arm.model import Arm
from fitter.data.motions import Measured
from fitter.data.trial import Trial
from fitter.data.trials import read_set, to_trials
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note, documents, of_source
from protocol.tables.files import expand

#: Corners of the filter of derived columns and of the fit's own [Hz]; None where they are to be chosen.
Filters = tuple[float | None, float | None]


def motions_of(arguments: argparse.Namespace, arm: Arm, sources: Sequence[Path]) -> list[Measured]:
    """Read a set by the options for columns, rate and recordings, see `fitter.data.trials.read_set`."""
    return read_set(
        sources,
        arm.n_joint,
        arguments.columns,
        rate_hz=arguments.rate_hz,
        arm=arm,
        as_tracked=arguments.as_tracked,
    )


def trial_sets(
    arguments: argparse.Namespace, arm: Arm, learn: Sequence[Path], filters: Filters
) -> tuple[list[Trial], list[Trial]]:
    """Read the trials to learn from and those of ``--evaluate``; recordings whose motions have roles give both.

    Without ``--evaluate``, motions that a recording marks as evaluating are held back.

    Parameters
    ----------
    arguments : argparse.Namespace
    arm : Arm
    learn : sequence of Path
    filters : Filters

    Returns
    -------
    learn, evaluate : list of Trial
        What is compared has passed the same filters, and these are chosen by the learning trials alone.

    Raises
    ------
    ConfigError
        If a file is in both sets.
    DataError
        If nothing can be learnt from.
    """
    require_apart(learn, arguments.evaluate)
    motions = motions_of(arguments, arm, learn)
    held_back = [] if arguments.evaluate else evaluating(motions)
    learning = motions if arguments.evaluate else [motion for motion in motions if motion.role != "evaluate"]
    if not learning:
        raise DataError(f"{', '.join(map(str, learn))}: no trial with role 'learn' in it")
    trials = to_trials(learning, arguments.rate_hz, *filters)
    if arguments.evaluate:
        held_back = motions_of(arguments, arm, arguments.evaluate)
    corners = trials[0].cutoff_hz, trials[0].band_hz
    return _numbered(trials, to_trials(held_back, arguments.rate_hz, *corners) if held_back else [])


def evaluating(motions: Sequence[Measured]) -> list[Measured]:
    """Return the motions that a recording marks as evaluating."""
    return [motion for motion in motions if motion.role == "evaluate"]


def _numbered(learn: Sequence[Trial], evaluate: Sequence[Trial]) -> tuple[list[Trial], list[Trial]]:
    """Return trials with their numbers in the run, those learnt from first."""
    every = [replace(trial, number=number) for number, trial in enumerate((*learn, *evaluate), 1)]
    return every[: len(learn)], every[len(learn) :]


def notes_of(trials: Sequence[Trial]) -> tuple[Note, ...]:
    """Return the notes of trials, each with the trial's name as its source."""
    return tuple(note for trial in trials for note in of_source(trial.notes, trial.name))


def with_notes(answer: Mapping[str, object], notes: Sequence[Note]) -> dict[str, object]:
    """Return a JSON document with the notes of the data before those of the answer itself."""
    own = answer.get("notes", [])
    assert isinstance(own, list)
    return {**answer, "notes": [*documents(notes), *own]}


def require_apart(learn: Sequence[Path], evaluate: Sequence[Path]) -> None:
    """Make sure that no file is both learnt from and evaluated on.

    Raises
    ------
    ConfigError
        If one is, or there is no such file.
    """
    if evaluate:
        held_back = {path.resolve() for path in expand(evaluate)}
        both = [str(path) for path in expand(learn) if path.resolve() in held_back]
        if both:
            raise ConfigError(f"--evaluate: {both[0]} is learnt from, expected trials that are not")
