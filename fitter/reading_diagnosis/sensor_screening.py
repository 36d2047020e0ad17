"""What every effect of a sensor would explain, to first order: all of them from one elimination of the motion.

The readings are linearised along the motion that the other sensors show. The Gram matrix of the residuals of all
columns gives each effect's best parameters by the learning trials, and the judging trials' residual. A base may
move at the highest peaks of its spectrum; what is slower than a trial is indistinguishable from an arm that
rests at another angle, so each trial's own trend is left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from arm.model import Floats
from fitter.diagnosis.least_squares import N_REFINED
from fitter.reading_diagnosis.sensor_hypotheses import (
    USUAL_BIAS_M_S2,
    Fitted,
    SensorHypothesis,
    Suspect,
    with_suspect,
)
from fitter.reading_diagnosis.trial_equations import Trials


def base_frequencies(trials: Trials, free: Fitted, lowest_hz: float = 0.1, finer: int = 4) -> list[float]:
    """Return the frequencies [Hz] of the highest peaks in a base's acceleration.

    Parameters
    ----------
    trials : Trials
    free : Fitted
        With the motions of a base that may move in any way.
    lowest_hz : float
        A base that moves more slowly looks like one that is not level.
    finer : int
        Grid points a natural step of the spectrum.
    """
    times, base = [], []
    hypothesis = replace(free.hypothesis, free_base=False)
    for number in range(trials.n_learn):
        at = trials.linearised(number, hypothesis, free.motions[number])
        felt, unit = at.from_base() * at.weight[..., None], at.residual * at.weight
        normal = np.einsum("kcx,kcy->kxy", felt, felt) + 1e-9 * np.eye(3)
        felt_most = np.linalg.solve(normal, np.einsum("kcx,kc->kx", felt, unit)[..., None])[..., 0]
        base.append(scipy.signal.detrend(felt_most, axis=0))
        times.append(at.trial.t)
    t, a, dt = np.concatenate(times), np.concatenate(base), trials.trials[0].dt_s
    place = np.round((t - t[0]) / dt).astype(int)
    even: Floats = np.zeros((int(place[-1]) + 1, 3))
    even[place] = a
    n = finer * len(even)
    power = (np.abs(np.fft.rfft(even, n=n, axis=0)) ** 2).sum(axis=1)
    frequency = np.fft.rfftfreq(n, dt)
    power[frequency < lowest_hz] = 0.0
    peaks, _ = scipy.signal.find_peaks(power, distance=4 * finer)
    highest = peaks[np.argsort(-power[peaks])][:N_REFINED]
    return [float(frequency[peak]) for peak in highest]


@dataclass(frozen=True)
class Screened:
    """What a suspect would explain.

    Attributes
    ----------
    suspect : Suspect
    value : (n_parameter,)
        Its best parameters, to first order.
    motions : list of (n + 2, n_joint)
        The motions that the other sensors show.
    learn, judge : float
        Squared residual of the learning and of the judging trials that it leaves, with what the small biases cost.
    """

    suspect: Suspect
    value: Floats
    motions: list[Floats]
    learn: float
    judge: float


def screened(
    trials: Trials, known: SensorHypothesis, new: Sequence[tuple[Suspect, Floats]], motions: list[Floats]
) -> list[Screened]:
    """Return what each of several suspects would explain on top of what is known.

    Parameters
    ----------
    trials : Trials
    known : SensorHypothesis
    new : sequence of (Suspect, value)
        With where their parameters start; together they must leave everything as it is.
    motions : list of (n + 2, n_joint)
    """
    whole = known
    for suspect, value in new:
        whole = with_suspect(whole, suspect, value)
    done = trials.all_eliminated(range(len(trials.trials)), whole, motions, whole.suspects)
    grams = [gram for gram, _ in done]
    for number, gram in enumerate(grams):
        gram[-1, -1] += trials.dropped(number, whole, motions[number])
    mean, std = trials.before(whole)
    theta = np.concatenate([whole.bias.ravel(), *whole.values])
    learn, judge = (np.sum(part, axis=0) for part in (grams[: trials.n_learn], grams[trials.n_learn :]))
    n_known = known.bias.size + sum(value.size for value in known.values)
    found, begin = [], n_known
    for suspect, value in new:
        at = np.r_[0:n_known, begin : begin + value.size]
        begin += value.size
        step = np.linalg.solve(
            learn[np.ix_(at, at)] + np.diag(1.0 / std[at] ** 2), learn[at, -1] + (mean - theta)[at] / std[at] ** 2
        )
        usual = float(np.sum(((theta + _at(step, at, theta.size))[: known.bias.size] / USUAL_BIAS_M_S2) ** 2))
        squares = [
            float(gram[-1, -1] - 2.0 * step @ gram[at, -1] + step @ gram[np.ix_(at, at)] @ step) + usual
            for gram in (learn, judge)
        ]
        found.append(Screened(suspect, value + step[n_known:], motions, *squares))
    return found


def _at(step: Floats, places: Floats, size: int) -> Floats:
    whole = np.zeros(size)
    whole[places] = step
    return whole
