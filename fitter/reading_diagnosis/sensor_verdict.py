"""Which suspects are accepted, and which are indistinguishable.

A cause is accepted if it explains more of trials that it was not fitted to than chance would, in units of the
noise. A rival is its equal if these trials don't distinguish the two; then the one with fewer numbers that differ
from nothing is preferred, and if they have as many, both are named.

Its finding says so, with the numbers of the causes and what they leave.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from arm.model import Arm, Floats
from fitter.diagnosis.least_squares import MOST_CAUSES, SIGMAS
from fitter.diagnosis.search import Verdict
from fitter.reading_diagnosis.sensor_hypotheses import Fitted, without_suspect
from fitter.reading_diagnosis.sensor_residual import SensorResidual, beyond_level
from fitter.reading_diagnosis.sensor_search import ACCEPTED, EQUAL, Search, Tried


@dataclass(frozen=True)
class Cause:
    """An accepted suspect, with those that explain as much.

    Attributes
    ----------
    tried : Tried
    equals : tuple of Tried
        Rivals that are indistinguishable from it; empty if there are none.
    support : float
        In which share of the ways to draw the judging trials anew it beats every rival that is not its equal.
    """

    tried: Tried
    equals: tuple[Tried, ...]
    support: float


@dataclass(frozen=True)
class Decision:
    """What the search came to.

    Attributes
    ----------
    causes : tuple of Cause
    first : list of Tried
        All suspects, tried on the arm file's own sensors.
    fitted : Fitted
        With all causes.
    """

    causes: tuple[Cause, ...]
    first: list[Tried]
    fitted: Fitted


def decide(search: Search, rng: np.random.Generator) -> Decision:
    """Add causes one at a time until nothing more is explained, then ask again whether each is needed.

    Parameters
    ----------
    search : Search
    rng : Generator
        Draws trials anew for the causes' support.
    """
    known = search.base
    causes: list[Cause] = []
    first: list[Tried] = []
    while len(causes) < MOST_CAUSES:
        tried = search.try_all(known)
        first = first or tried
        found = _accepted(search, known, tried, rng)
        if found is None or found.tried.fitted is None:
            break
        causes.append(found)
        known = search.settle(found.tried.fitted)
        if not search.doubtful(known):
            break
    for cause in list(causes) if len(causes) > 1 else []:
        others = [one for one in causes if one is not cause]
        known_less = search.fit_again(without_suspect(known.hypothesis, cause.tried.suspect), known.motions)
        if search.score(known_less) - search.score(known) < ACCEPTED:
            causes, known = others, known_less
    return Decision(tuple(causes), first, known)


def significant(search: Search, tried: Tried) -> int:
    """Return how many of a suspect's numbers differ from nothing."""
    if tried.fitted is None:
        return 0
    if tried.suspect.kind.frees_base:  # what that costs stands in its score
        return sum(3 * len(motion) for motion in tried.fitted.motions[search.trials.n_learn :])
    place = tried.fitted.hypothesis.suspects.index(tried.suspect)
    value, std = tried.fitted.hypothesis.values[place], tried.fitted.std(place) * np.sqrt(search.noise)
    neutral = np.array(tried.suspect.kind.neutral)
    if np.abs(value).max() < tried.suspect.kind.least:
        return 0
    if tried.suspect.kind.is_level and tried.suspect.sensor is not None:
        return int(beyond_level(search.trials, tried.fitted, tried.suspect.sensor) > SIGMAS)
    there = np.abs(value - np.where(np.isfinite(neutral), neutral, 0.0)) > SIGMAS * std
    return int(np.count_nonzero(there))


def _accepted(search: Search, known: Fitted, tried: Sequence[Tried], rng: np.random.Generator) -> Cause | None:
    score = search.score(known)
    able = [one for one in tried if significant(search, one) and score - one.score > ACCEPTED]
    if not able:
        return None
    best = min(able, key=lambda one: one.score)
    equals = [one for one in able if _beats(best, one) <= 0.0]
    fewest = min(significant(search, one) for one in equals)
    equals = [one for one in equals if significant(search, one) == fewest]
    best = min(equals, key=lambda one: one.score)
    others = [one for one in able if one not in equals]
    return Cause(best, tuple(one for one in equals if one is not best), _support(best, others, rng))


def _beats(one: Tried, other: Tried) -> float:
    """Return by how much more one explains than another, beyond what leaves them equal."""
    each = other.each - one.each
    spread = 2.0 * np.sqrt(each.size) * float(each.std(ddof=1)) if each.size > 1 else 0.0
    whole = other.score - one.score
    return whole - (EQUAL + min(spread, 0.5 * whole))


def _support(best: Tried, others: Sequence[Tried], rng: np.random.Generator, n_drawn: int = 1000) -> float:
    n = best.each.size
    drawn = rng.integers(0, n, (n_drawn, n))
    usual = best.score - best.each.sum()
    won = np.ones(len(drawn), dtype=np.bool_)
    for other in others:
        won &= (other.each - best.each)[drawn].sum(axis=1) + (other.score - other.each.sum()) > usual
    return float(np.mean(won))


@dataclass(frozen=True)
class Number:
    """A parameter with its standard error."""

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class SensorCause:
    """A cause.

    Attributes
    ----------
    effect : str
        As in the catalogue.
    sensors : tuple of str
        Empty for an effect that all sensors feel.
    parameters : mapping of str to Number
    support : float
        From 0 to 1: in which share of the ways to draw the judging trials anew it beats every rival that is not
        its equal; shared among equals.
    """

    effect: str
    sensors: tuple[str, ...]
    parameters: Mapping[str, Number]
    support: float


@dataclass(frozen=True)
class SensorCandidate:
    """An effect that was tried on the arm file's own sensors.

    Attributes
    ----------
    effect : str
    sensors : tuple of str
    gain : float
        Share of what contradicts a rigid arm in the judging trials that it takes away, 0 to 1.
    support : float
    """

    effect: str
    sensors: tuple[str, ...]
    gain: float
    support: float


@dataclass(frozen=True)
class Course:
    """Judging trials for a plot.

    Attributes
    ----------
    t : (n,) [s]
        On the run's clock.
    before, after : (n, n_sensor, 3) [m/s^2]
        What no motion explains of the readings, without the causes and with them.
    fitted : (n, n_sensor, 3) [m/s^2]
        What the causes say the sensors read.
    """

    t: Floats
    before: Floats
    after: Floats
    fitted: Floats


@dataclass(frozen=True)
class SensorFinding:
    """Whether the sensors contradict a rigid arm, and why.

    Attributes
    ----------
    verdict : {"named", "ambiguous", "none", "unexplained"}
    causes : tuple of SensorCause
        Of an ambiguous finding all that explain equally well.
    candidates : tuple of SensorCandidate
        All that were tried, the best first.
    confusable : tuple of (str, str)
        Effects that this data cannot distinguish.
    next_experiment : str
    before, after : mapping of str to float
        By sensor, rms of what no motion of a rigid arm explains in the judging trials [m/s^2], every frame counted
        as in the verdict.
    gain : float
        Share of these rms, squared, that the causes take away.
    contradicts : float
        Of the arm file as it is: how many standard deviations of mere noise the sensors are from a rigid arm.
    beyond_noise : float
        Variance that then contradicts beyond the sensors' noise, in units of it.
    times_noise : float
        What contradicts with the causes, in units of the sensors' noise, as rms.
    residual : SensorResidual
    arm : Arm
        With the causes as its effects.
    course : Course
    """

    verdict: Verdict
    causes: tuple[SensorCause, ...]
    candidates: tuple[SensorCandidate, ...]
    confusable: tuple[tuple[str, str], ...]
    next_experiment: str
    before: Mapping[str, float]
    after: Mapping[str, float]
    gain: float
    contradicts: float
    beyond_noise: float
    times_noise: float
    residual: SensorResidual
    arm: Arm
    course: Course
