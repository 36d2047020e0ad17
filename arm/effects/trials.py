"""In which trials of a run an effect acts, and from when on.

With ``trials`` it acts in those, by number or by name, and in no others; with ``since_s`` from that time on; with
both, from that time of the first of these trials on, and in the others all along; with neither, always.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from arm.effects.effect import LATEST_S, Parameter, Values, number

#: What an effect lists its trials by.
TRIALS = Parameter("trials", "1", 1.0, 1e6, optional=True, several=True)
#: Where it has one: the time from which on it acts.
SINCE = Parameter("since_s", "s", -LATEST_S, LATEST_S, optional=True)


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


def acts_from(values: Values, trial: AnyTrial) -> float:
    """Return the time from which an effect acts in a trial [s], on its clock; infinite where it does not."""
    if not acts_in(values, trial):
        return math.inf
    listed = trials_of(values)
    begins = not listed or is_trial(listed[0], trial)
    return number(values, SINCE.name) if begins and SINCE.name in values else -math.inf
