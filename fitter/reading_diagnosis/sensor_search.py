"""The search for causes: every suspect is tried with those accepted before, and judged on other trials.

A fit starts from the motion that the other sensors show, so that a sensor's gross fault does not spoil the motion
against which it is seen. All suspects are tried to first order; those that come near the best are fitted in full.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from arm.model import Arm, Floats
from fitter.diagnosis.least_squares import N_REFINED, NEGLIGIBLE, ODDS_NATS, SIGMAS
from fitter.reading_diagnosis.free_base import freedom
from fitter.reading_diagnosis.sensor_fit import fit, judge
from fitter.reading_diagnosis.sensor_frames import FRAME_RATE_HZ, TrialFrames
from fitter.reading_diagnosis.sensor_hypotheses import (
    USUAL_BIAS_M_S2,
    Fitted,
    SensorHypothesis,
    Suspect,
    with_suspect,
)
from fitter.reading_diagnosis.sensor_residual import Contradiction, contradiction, noise_factor
from fitter.reading_diagnosis.sensor_screening import Screened, base_frequencies, screened
from fitter.reading_diagnosis.suspected_effects import EFFECTS
from fitter.reading_diagnosis.trial_equations import Trials
from limbcal.errors import DataError
from tracking.model.readings import Readings
from tracking.smoother.coarsening import finer
from tracking.smoother.rough_motion import rough_motion
from tracking.smoother.smoother import Smoother

#: What a cause must explain, and by what it must beat a rival: squared, in noise units. Chosen by hand, with
#: a margin over 16 runs of the bench without any effect (seeds 1001 to 1003 and 1010 to 1014, lying and hanging):
#: there no suspect whose numbers differ from nothing explained more than 2.3. Those whose numbers don't, which are
#: never accepted, explained up to 31: levels drawn through the peaks of sound sensors.
ACCEPTED, EQUAL = 20.0, 12.0


def smoothed_states(arm: Arm, readings: Readings, q: Floats, given: bool) -> Floats | None:
    """Return the states of an exact arm, (n, n_state), or None if no motion of it explains the readings at all."""
    try:
        return Smoother(arm, q, given).smooth(readings).states
    except DataError:
        return None


def rough_states(arm: Arm, readings: Readings, q: Floats, given: bool) -> Floats | None:
    """Return the states of a rough motion, (n, n_state), or None if there is none."""
    found = rough_motion(arm, readings, q, given)
    return None if found is None else finer(found.states, len(readings.values), found.stride)


def first_motions(
    arm: Arm, trials: Sequence[TrialFrames], states_of: Callable[..., Floats | None] = smoothed_states
) -> list[Floats]:
    """Return spline coefficients (n + 2, n_joint) of every trial; the arm is at its zero where the run begins.

    A motion that is not found at all begins as a standstill.
    """
    q = np.zeros(arm.n_joint)
    motions = []
    for trial in trials:
        states = states_of(arm, trial.raw.readings(FRAME_RATE_HZ), q, trial.continues)
        if states is None:
            path = np.tile(q, (len(trial.values), 1))
        else:
            path = states[np.minimum(np.arange(len(trial.values)), len(states) - 1), : 3 * arm.n_joint : 3]
        motions.append(np.vstack([2.0 * path[0] - path[1], path, 2.0 * path[-1] - path[-2]]))
        q = path[-1]
    return motions


@dataclass(frozen=True)
class Tried:
    """One suspect on top of what was known.

    Attributes
    ----------
    suspect : Suspect
    score : float
        Squared residual of the judging trials that contradicts rigidity, and what the small biases cost; in units
        of the noise. The smaller the better.
    fitted : Fitted or None
        None where it was tried to first order only.
    each : (n_judging,)
        The squared residual by trial; empty where it was tried to first order only.
    """

    suspect: Suspect
    score: float
    fitted: Fitted | None
    each: Floats


class Search:
    """Tries suspects on the trials.

    Parameters
    ----------
    trials : Trials
    progress : callable, optional
        Called after every fit.
    rough : int
        Passes of the fits that only show which sensor is the odd one.
    """

    def __init__(self, trials: Trials, progress: Callable[[], None] | None = None, rough: int = 5) -> None:
        self.trials, self._rough = trials, rough
        self._tell = progress or (lambda: None)
        motions = first_motions(trials.arm, trials.trials)
        self.base = judge(trials, fit(trials, trials.nothing(), motions))
        self.noise = noise_factor(trials, self.base)

    @cached_property
    def _rough_motions(self) -> list[Floats]:
        return first_motions(self.trials.arm, self.trials.trials, rough_states)

    def score(self, fitted: Fitted) -> float:
        """Return the score of a judged fit."""
        return float(self.each(fitted).sum() + fitted.usual + fitted.surprise)

    def each(self, fitted: Fitted) -> Floats:
        """Return the squared residual of every judging trial in units of the noise, what was dropped as noise.

        What is free in every frame costs what it takes to know it.
        """
        hypothesis, judging = fitted.hypothesis, range(self.trials.n_learn, len(self.trials.trials))
        dropped = [self.trials.dropped(k, hypothesis, fitted.motions[k]) for k in judging]
        free = [freedom(self.trials, fitted, k) for k in judging]
        squares: Floats = fitted.squares[self.trials.n_learn :] / self.noise + np.array(dropped) + np.array(free)
        return squares

    def contradiction(self, fitted: Fitted) -> Contradiction:
        """Return what of a fit contradicts a rigid arm."""
        return contradiction(self.trials, fitted, self.noise)

    def full(self, suspect: Suspect, fitted: Fitted) -> Tried:
        """Judge a fit in full; where readings contradict it, from a rough motion as well."""
        fitted = judge(self.trials, fitted)
        if self.contradiction(fitted).sigmas > SIGMAS:  # a motion may be caught far from where it should be
            n = self.trials.n_learn
            again = judge(self.trials, replace(fitted, motions=[*fitted.motions[:n], *self._rough_motions[n:]]))
            both = zip(fitted.motions, again.motions, again.squares < fitted.squares, strict=True)
            motions = [new if better else old for old, new, better in both]
            fitted = judge(self.trials, replace(fitted, motions=motions))
        self._tell()
        return Tried(suspect, self.score(fitted), fitted, self.each(fitted))

    def settle(self, fitted: Fitted) -> Fitted:
        """Measure the noise anew, now that less contradicts, and return the fit."""
        self.noise = noise_factor(self.trials, fitted)
        return fitted

    def doubtful(self, fitted: Fitted) -> bool:
        """Return whether something may still be wrong: the residual exceeds noise, or a bias is unusual."""
        worst = float(np.sum((fitted.hypothesis.bias / USUAL_BIAS_M_S2) ** 2, axis=1).max())
        return self.contradiction(fitted).sigmas > SIGMAS or worst > scipy.stats.chi2.isf(np.exp(-ODDS_NATS), 3)

    def fit_again(self, hypothesis: SensorHypothesis, motions: list[Floats]) -> Fitted:
        """Return a hypothesis fitted and judged."""
        return judge(self.trials, fit(self.trials, hypothesis, motions))

    def _begun_anew(self, fitted: Fitted) -> Fitted:
        instruments = fitted.hypothesis.instruments(self.trials.nominal)
        sensors = [
            replace(sensor, highpass_hz=float(corner))
            for sensor, corner in zip(instruments.arm.sensors, instruments.corner_hz, strict=True)
        ]
        motions = first_motions(replace(instruments.arm, sensors=tuple(sensors)), self.trials.trials)
        again = judge(self.trials, fit(self.trials, fitted.hypothesis, motions))
        if again.cost > fitted.cost + EQUAL:
            return fitted
        better = fitted.squares < again.squares
        both = zip(fitted.motions, again.motions, better, strict=True)
        motions = [old if keep else new for old, new, keep in both]
        squares = np.where(better, fitted.squares, again.squares)
        return replace(again, motions=motions, squares=squares)

    def try_all(self, known: Fitted) -> list[Tried]:
        """Return every suspect that may come on top of what is known, the best first."""
        candidates = self._screen(known)
        start = known.cost
        candidates.sort(key=lambda one: one.learn)
        found = []
        for rank, one in enumerate(candidates):
            if rank < N_REFINED and start - one.learn > EQUAL:
                hypothesis = with_suspect(known.hypothesis, one.suspect, one.value)
                found.append(self.full(one.suspect, fit(self.trials, hypothesis, one.motions)))
            else:
                found.append(Tried(one.suspect, one.judge / self.noise, None, np.empty(0)))
        # What was not fitted in full keeps its place behind what was.
        found.sort(key=lambda tried: (tried.fitted is None, tried.score))
        numbered = next(k for k, one in enumerate(found) if not one.suspect.kind.frees_base)
        for k in {0, numbered}:  # a base that is free hides that another one's motions may have begun too far off
            fitted = found[k].fitted
            if fitted is not None and self.contradiction(fitted).excess > NEGLIGIBLE:
                found[k] = self.full(found[k].suspect, self._begun_anew(fitted))
        found.sort(key=lambda tried: (tried.fitted is None, tried.score))
        return found

    def _screen(self, known: Fitted) -> list[Screened]:
        """Return what every suspect would explain: those that begin as neutral together, each other one alone."""
        there, found = known.hypothesis.suspects, []
        learn = self.trials.trials[: self.trials.n_learn]
        for s in range(len(self.trials.arm.sensors)):
            motions = self._without(known, s)
            own = [one for kind in EFFECTS if not kind.whole and (one := Suspect(kind, s)) not in there]
            groups = [[(one, np.array(one.kind.neutral)) for one in own if one.kind.begins_neutral]]
            for one in own:
                first = one.kind.first and one.kind.first(learn, self.trials.nominal, s)
                if first is not None:
                    groups.append([(one, first)])
            for group in groups:
                found += screened(self.trials, known.hypothesis, group, motions)
            self._tell()
        return found + self._screen_base(known)

    def _without(self, known: Fitted, sensor: int) -> list[Floats]:
        """Return the motions that the other sensors show."""
        odd = np.zeros(len(self.trials.arm.sensors), dtype=np.bool_)
        odd[sensor] = True
        blind = fit(self.trials, replace(known.hypothesis, without=odd), known.motions, self._rough)
        return judge(self.trials, blind, self._rough).motions

    def _screen_base(self, known: Fitted) -> list[Screened]:
        there = {suspect.effect for suspect in known.hypothesis.suspects}
        free = fit(self.trials, replace(known.hypothesis, free_base=True), known.motions, self._rough)
        free = judge(self.trials, free, self._rough)
        found = []
        for kind in EFFECTS:
            if not kind.whole or kind.name in there:
                continue
            if kind.frees_base:
                cost = sum(freedom(self.trials, free, k) for k in range(self.trials.n_learn))
                own = Suspect(kind), np.empty(0), free.motions, free.cost + cost, self.score(free) * self.noise
                found.append(Screened(*own))
            else:
                neutral, last = kind.neutral[:-1], [kind.neutral[-1]]
                last = last if kind.begins_neutral else base_frequencies(self.trials, free)
                places = [[(Suspect(kind), np.array([*neutral, one]))] for one in last]
                tried = [one for at in places for one in screened(self.trials, known.hypothesis, at, free.motions)]
                found += [min(tried, key=lambda one: one.learn)] if tried else []
        return found
