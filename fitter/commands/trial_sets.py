"""The trials to learn from and those held back: never mixed."""

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from arm.model import Arm
from fitter.data.trial import Role, Trial
from fitter.data.trials import load_trials
from limbcal.errors import ConfigError
from limbcal.note import Note, documents, of_source
from protocol.tables.files import expand

#: Reads trials of one role, or all, with the corners of two filters where these are chosen already.
Load = Callable[[Sequence[Path], Role | None, tuple[float, float] | None], list[Trial]]


def load_set(
    arguments: argparse.Namespace,
    arm: Arm,
    sources: Sequence[Path],
    role: Role | None,
    filters: tuple[float | None, float | None],
) -> list[Trial]:
    """Read a set of trials by the options for columns and rate, see `fitter.data.trials.load_trials`.

    Parameters
    ----------
    arguments : argparse.Namespace
    arm : Arm
    sources : sequence of Path
    role : {"learn", "evaluate"} or None
    filters : (float or None, float or None)
        Corners of the filter of derived columns and of the fit's own [Hz].
    """
    cutoff_hz, band_hz = filters
    return load_trials(
        sources,
        arm.n_joint,
        arguments.columns,
        rate_hz=arguments.rate_hz,
        cutoff_hz=cutoff_hz,
        band_hz=band_hz,
        role=role,
        arm=arm,
    )


def trial_sets(load: Load, learn: Sequence[Path], evaluate: Sequence[Path]) -> tuple[list[Trial], list[Trial]]:
    """Read both sets; recordings whose motions have roles give both.

    Parameters
    ----------
    load : callable
        Given sources, a role and filters, returns trials.
    learn, evaluate : sequence of Path
        Without ``evaluate``, motions that a recording marks as evaluating are held back.

    Returns
    -------
    learn, evaluate : list of Trial
        What is compared has passed the same filters, and these are chosen by the learning trials alone.

    Raises
    ------
    ConfigError
        If a file is in both sets.
    """
    require_apart(learn, evaluate)
    trials = load(learn, None, None)
    held_back = [trial for trial in trials if trial.role == "evaluate"]
    if evaluate:
        return _numbered(trials, load(evaluate, None, _filters(trials)))
    if not held_back:
        return _numbered(trials, [])
    trials = load(learn, "learn", None)
    cutoff_hz, band_hz = _filters(trials)
    # Frames come with their derivatives: nothing in them was filtered yet.
    return _numbered(trials, [replace(trial, cutoff_hz=cutoff_hz, band_hz=band_hz) for trial in held_back])


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


def _filters(trials: Sequence[Trial]) -> tuple[float, float]:
    return trials[0].cutoff_hz, trials[0].band_hz


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
