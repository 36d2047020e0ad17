"""How much the sensors contradict a rigid arm, in units of their own noise, and what it looks like."""

from dataclasses import dataclass

import numpy as np

from fitter.diagnosis.sensors.fit import Fitted, Trials
from fitter.diagnosis.sensors.linearisation import Linearisation, linearise

#: Median of a mean of ten squares of unit variance: what a frame's differences are made of, nearly enough.
_MEDIAN_OF_TEN = 0.934


@dataclass(frozen=True)
class Contradiction:
    """Squared residual of the judging trials.

    Attributes
    ----------
    beyond : float
        What it has beyond noise, in units of the noise.
    excess : float
        The same as a share of the noise.
    sigmas : float
        How many standard deviations of mere noise that is.
    """

    beyond: float
    excess: float
    sigmas: float


def judging_residuals(trials: Trials, fitted: Fitted) -> list[Linearisation]:
    """Return the judging trials along their fitted motions."""
    return [
        trials.explained(number, fitted.hypothesis, fitted.motions[number])
        for number in range(trials.n_learn, len(trials.trials))
    ]


def noise_factor(trials: Trials, fitted: Fitted) -> float:
    """Return the noise's variance as a share of what was measured in third differences of the readings.

    What is left from frame to frame once the motion is known is nearly nothing but noise, whatever the sensors
    get wrong slowly; the median over frames does not mind a jolt.
    """
    squares = []
    for at in judging_residuals(trials, fitted):
        unit = at.residual * at.weight
        free = np.count_nonzero(at.weight > 0.0, axis=1) - trials.arm.n_joint
        change = np.diff(unit, axis=0)
        there = free[1:] > 0
        squares.append(((change**2).sum(axis=1)[there] / 2.0) / free[1:][there])
    return float(np.median(np.concatenate(squares)) / _MEDIAN_OF_TEN)


def beyond_level(trials: Trials, fitted: Fitted, sensor: int) -> float:
    """Return how far beyond its level a clipped sensor should read on average, in standard deviations of a frame.

    One that truly clips should have read more; a level drawn through a sound one's peaks is what it should read.
    """
    instruments = fitted.hypothesis.instruments(trials.nominal)
    level = float(instruments.level[sensor])
    channels = slice(3 * sensor, 3 * sensor + 3)
    further = []
    for number in range(trials.n_learn):
        trial, c = trials.trials[number], fitted.motions[number]
        clipped = linearise(trial, instruments, c).clipped[:, channels]
        expected = linearise(trial, instruments.with_entry("level", sensor, np.inf), c).expected[:, channels]
        further.append(((clipped * expected - level) / trial.std[channels])[clipped != 0.0])
    found = np.concatenate(further)
    return float(found.mean()) if found.size else 0.0


def contradiction(trials: Trials, fitted: Fitted, noise: float) -> Contradiction:
    """Return how far a judged fit is from mere noise."""
    free = 0
    for number in range(trials.n_learn, len(trials.trials)):
        trial = trials.trials[number]
        there = np.isfinite(trial.values)
        free += int(there.sum() - trials.arm.n_joint * np.count_nonzero(there.any(axis=1)))
        free -= trials.dropped(number, fitted.hypothesis, fitted.motions[number])
    beyond = float(fitted.squares[trials.n_learn :].sum()) / noise - free
    # The noise itself was measured in about as many numbers, by a median, which knows it half as well.
    return Contradiction(beyond, beyond / free, beyond / np.sqrt(2.0 * free * (1.0 + 2.0)))
