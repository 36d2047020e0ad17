"""Effects on the clock and the trial numbers of a run, and on those of the trials themselves.

A diagnosis puts its trials on one clock and counts them. An arm file knows neither: what acts only sometimes has
its trial's name or label there, and a time on that trial's own clock.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from arm.effects.catalogue import catalogue
from arm.effects.effect import number
from arm.effects.trials import SINCE, TRIALS, acts_from, acts_in
from arm.model import Effect
from fitter.diagnosis.motion import Motion

#: What a diagnosis calls a trial: by its label, its name, or its place in the run.
Entry = int | str


def entries(motions: Sequence[Motion]) -> dict[int, Entry]:
    """Return what an arm file calls each trial, by its number: its label if no other has it, or else its name.

    Where neither distinguishes it, its place in the run has to.
    """
    numbers = Counter(motion.identity.number for motion in motions)
    names = Counter(motion.identity.name for motion in motions if not motion.trial.piece_of)
    called: dict[int, Entry] = {}
    for motion in motions:
        label, name = motion.identity
        if motion.trial.label.isdecimal() and numbers[label] == 1:
            called[motion.number] = label
        else:
            called[motion.number] = name if names[name] <= 1 else motion.number
    return called


def trial_at(motions: Sequence[Motion], at_s: float) -> Motion:
    """Return the trial that an instant of the run's clock is in, or the one nearest to it."""
    return min(motions, key=lambda motion: max(float(motion.t[0]) - at_s, at_s - float(motion.t[-1])))


def begins_in(motions: Sequence[Motion], since_s: float) -> Motion:
    """Return the trial in which something begins that lasts from an instant of the run's clock on."""
    return next((motion for motion in motions if float(motion.t[-1]) >= since_s), motions[-1])


def on_run(effects: Sequence[Effect], motions: Sequence[Motion]) -> list[Effect]:
    """Return an arm file's effects, those that act only sometimes on the clock and the numbers of a run.

    Parameters
    ----------
    effects : sequence of Effect
    motions : sequence of Motion
        All trials that they are to be simulated in.
    """
    found: list[Effect] = []
    for effect in effects:
        values = effect.parameters
        acting = [motion for motion in motions if acts_in(values, motion.identity)]
        if catalogue()[effect.name].event:
            for motion in acting:
                start = number(values, "start_s") + motion.ahead_s
                found.append(replace(effect, parameters={**values, "start_s": start, "trials": [motion.number]}))
        elif TRIALS in catalogue()[effect.name].parameters:
            own = {name: value for name, value in values.items() if name not in (TRIALS.name, SINCE.name)}
            since = {motion.number: acts_from(values, motion.identity) + motion.ahead_s for motion in acting}
            whole = [trial for trial, at in since.items() if at == -math.inf]
            if whole:
                found.append(replace(effect, parameters={**own, TRIALS.name: whole}))
            for trial, at in since.items():
                if math.isfinite(at):
                    found.append(replace(effect, parameters={**own, TRIALS.name: [trial], SINCE.name: at}))
        else:
            found.append(effect)
    return found


def on_trials(effects: Sequence[Effect], motions: Sequence[Motion]) -> list[Effect]:
    """Return a run's effects as an arm file has them: by what it calls the trials, on their own clocks.

    Parameters
    ----------
    effects : sequence of Effect
        On the run's clock, trials by their numbers in the run.
    motions : sequence of Motion
        All trials of the run, in their order.
    """
    called = entries(motions)
    found: list[Effect] = []
    for effect in effects:
        values = dict(effect.parameters)
        if catalogue()[effect.name].event:
            motion = trial_at(motions, number(values, "start_s"))
            values |= {"start_s": number(values, "start_s") - motion.ahead_s, "trials": [called[motion.number]]}
        elif "since_s" in values and any(motion.ahead_s for motion in motions):
            motion = begins_in(motions, number(values, "since_s"))
            later = [called[one.number] for one in motions if one.number >= motion.number]
            values |= {"since_s": number(values, "since_s") - motion.ahead_s, "trials": list(dict.fromkeys(later))}
        elif isinstance(trials := values.get("trials"), list):
            values["trials"] = list(dict.fromkeys(called[trial] for trial in trials))
        found.append(replace(effect, parameters=values))
    return found
