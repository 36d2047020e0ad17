"""The residual of the readings: how large, in units of the sensors' noise, and what it depends on.

Dependence is asked for without a form: means over bins of a variable, taken from every other judging trial, say
how much of the residual of the others they explain. What chance explains is found by shifting the residual in
time, which keeps its own course.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from arm.model import Floats
from fitter.diagnosis.least_squares import CLEAR_RATIO, NEGLIGIBLE, ROUNDED
from fitter.reading_diagnosis.linearisation import Linearisation, linearise
from fitter.reading_diagnosis.sensor_hypotheses import Fitted
from fitter.reading_diagnosis.trial_equations import Trials


@dataclass(frozen=True)
class SensorResidual:
    """The residual of the readings.

    Attributes
    ----------
    explained : float
        Share of it that a flexible regression on the motion explains in trials it has not seen.
    white : bool
        It is no more than noise.
    depends_on : tuple of str
        Variables, the strongest first: ``t``, ``q1``, ``dq1``, ``ddq1`` …
    """

    explained: float
    white: bool
    depends_on: tuple[str, ...]


def dependence_of_residual(
    judged: list[Linearisation], white: bool, rng: np.random.Generator, n_shifted: int = 99
) -> SensorResidual:
    """Describe the residual of the judging trials.

    Parameters
    ----------
    judged : list of Linearisation
        Along their fitted motions.
    white : bool
        It is no more than noise.
    rng : Generator
        Draws shifts.
    n_shifted : int
        Shifts in time that say what chance gives.
    """
    if white or len(judged) < 2:
        return SensorResidual(0.0, white, ())
    residuals = [at.residual * at.weight for at in judged]
    names, motions = _variables(judged)
    found: dict[str, float] = {}
    for k, name in enumerate(names):
        column = [motion[:, k] for motion in motions]
        share = _by_bins(column, residuals)
        chance = []
        for _ in range(n_shifted):
            shifted = [np.roll(r, int(rng.integers(len(r) // 10, 9 * len(r) // 10)), axis=0) for r in residuals]
            chance.append(_by_bins(column, shifted))
        if share > max(chance):
            found[name] = share
    best = max(found.values(), default=0.0)
    order = sorted((name for name in found if CLEAR_RATIO * found[name] > best), key=lambda name: -found[name])
    return SensorResidual(_by_polynomial(motions, residuals), False, tuple(order))


def _variables(judged: list[Linearisation]) -> tuple[list[str], list[Floats]]:
    n = judged[0].q.shape[1]
    names = ["t", *(f"{kind}{j + 1}" for kind in ("q", "dq", "ddq") for j in range(n))]
    return names, [
        np.column_stack([at.trial.t, at.q, at.dq, np.gradient(at.dq, at.trial.dt_s, axis=0)]) for at in judged
    ]


def _by_bins(column: list[Floats], residuals: list[Floats], bins: int = 12) -> float:
    edges = np.quantile(np.concatenate(column), np.linspace(0.0, 1.0, bins + 1)[1:-1])
    places = [np.searchsorted(edges, values) for values in column]
    gained = total = 0.0
    for half in (0, 1):
        means = np.zeros((bins, residuals[0].shape[1]))
        counts = np.zeros(bins)
        for place, r in zip(places[half::2], residuals[half::2], strict=True):
            np.add.at(means, place, r)
            counts += np.bincount(place, minlength=bins)
        means /= np.maximum(counts, 1.0)[:, None]
        for place, r in zip(places[1 - half :: 2], residuals[1 - half :: 2], strict=True):
            total += float(np.sum(r**2))
            gained += float(np.sum(r**2) - np.sum((r - means[place]) ** 2))
    return gained / total


def _by_polynomial(motions: list[Floats], residuals: list[Floats]) -> float:
    """Return what a polynomial of third degree and the directions of motion explain in trials left out."""
    whole = np.concatenate(motions)
    middle, size = whole.mean(axis=0), np.maximum(whole.std(axis=0), ROUNDED)
    n = (whole.shape[1] - 1) // 3

    def features(motion: Floats) -> Floats:
        x = (motion - middle) / size
        pairs = [x[:, a] * x[:, b] for a in range(x.shape[1]) for b in range(a + 1)]
        signs = np.sign(motion[:, 1 + n : 1 + 2 * n])
        return np.column_stack([np.ones(len(x)), x, *pairs, x**3, signs, signs * x[:, 1 + n : 1 + 2 * n]])

    A = [features(motion) for motion in motions]
    gained = total = 0.0
    for out in range(len(A)):
        others = [k for k in range(len(A)) if k != out]
        normal = sum((A[k].T @ A[k] for k in others), np.zeros((A[0].shape[1],) * 2))
        right = sum((A[k].T @ residuals[k] for k in others), np.zeros((A[0].shape[1], residuals[0].shape[1])))
        x = np.linalg.solve(normal + NEGLIGIBLE**2 * np.trace(normal) / len(normal) * np.eye(len(normal)), right)
        total += float(np.sum(residuals[out] ** 2))
        gained += float(np.sum(residuals[out] ** 2) - np.sum((residuals[out] - A[out] @ x) ** 2))
    return min(1.0, max(0.0, gained / total))


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


def noise_factor(trials: Trials, fitted: Fitted, degrees: int = 10) -> float:
    """Return the noise's variance as a share of what was measured in third differences of the readings.

    What is left from frame to frame once the motion is known is nearly nothing but noise, whatever the sensors
    get wrong slowly; the median over frames does not mind a jolt. A frame's differences
    have some ``degrees`` of freedom.
    """
    squares = []
    for at in judging_residuals(trials, fitted):
        unit = at.residual * at.weight
        free = np.count_nonzero(at.weight > 0.0, axis=1) - trials.arm.n_joint - 3 * fitted.hypothesis.free_base
        change = np.diff(unit, axis=0) / np.sqrt(1.0 - at.correlation)
        there = free[1:] > 0
        squares.append(((change**2).sum(axis=1)[there] / 2.0) / free[1:][there])
    return float(np.median(np.concatenate(squares)) / (scipy.stats.chi2.median(degrees) / degrees))


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
        free -= 3 * len(there) * fitted.hypothesis.free_base
    beyond = float(fitted.squares[trials.n_learn :].sum()) / noise - free
    # The noise itself was measured in about as many numbers, by a median, which knows it half as well.
    return Contradiction(beyond, beyond / free, beyond / np.sqrt(2.0 * free * (1.0 + 2.0)))
