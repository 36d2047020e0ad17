"""In which trials of a run an effect acts: in all, or in those that it lists, by number or by name."""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from arm.effects.effect import Parameter, Values

#: What an effect lists its trials by.
TRIALS = Parameter("trials", "1", 1.0, 1e6, optional=True, several=True)


class TrialId(NamedTuple):
    """What effects call a trial.

    Attributes
    ----------
    number : int
        Its own label, where that is a whole number, or else its place in the run, from 1.
    name : str
        The file's stem, and its label or cell where there are several in the file.
    """

    number: int
    name: str


#: A trial by what effects call it, or by its number alone.
AnyTrial: TypeAlias = int | TrialId


def trial_id(place: int, label: str, name: str) -> TrialId:
    """Return what effects call the trial at a place of a run (from 1), with its label and its name."""
    return TrialId(int(label) if label.isdecimal() else place, name)


def is_trial(entry: object, trial: AnyTrial) -> bool:
    """Say whether an effect's entry, a number or a name, is a trial."""
    return entry in trial if isinstance(trial, TrialId) else entry == trial


def trials_of(values: Values) -> Sequence[object] | None:
    """Return the numbers and names of the trials that an effect lists; None where it acts in all."""
    listed = values.get("trials")
    if listed is None:
        return None
    return list(listed) if isinstance(listed, list | tuple | np.ndarray) else [listed]


def acts_in(values: Values, trial: AnyTrial) -> bool:
    """Say whether an effect of these parameters acts in a trial."""
    listed = trials_of(values)
    return listed is None or any(is_trial(entry, trial) for entry in listed)
