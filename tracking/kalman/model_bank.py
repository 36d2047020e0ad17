r"""Filters side by side that differ in how much they hold their model to lack, weighed by predictive density.

Each takes the readings for those of `tracking.model.discrepancy` with sizes of its own, from a grid; what is known
is the mixture of all (multiple-model estimation: D. T. Magill, *Optimal adaptive estimation of sampled stochastic
processes*, 1965). An innovation e of covariance S has Student's density with :math:`\nu` degrees of freedom for
each sensor, and is taken in with the weight :math:`w = (\nu + 3) / (\nu + e^T S^{-1} e)`, if that is less than 1:
as if its covariance were S / w.

Nothing says that an arm lacks as much today as a minute ago. So evidence fades, and twice: a filter is held to be
as far behind as it is in the mean of the last moments or in that of the last seconds, whichever is more. When a
walk begins, little is believed at once; when it ends, only once the seconds have gone.
"""

import math
from typing import NamedTuple

import numpy as np

from arm.model import Floats
from limbcal.compiled import borrowed, compiled
from tracking.kalman.kalman_step import Taken, hold, predict, take
from tracking.model.course import Course
from tracking.model.discrepancy import FREEDOM
from tracking.model.expected_readings import Room, observe
from tracking.model.observation import Observation

#: Sizes that are tried [m/s^2], half a decade apart: from what a calibrated pendulum lacks to a blow.
_SIZES = (0.03, 0.1, 0.3, 1.0, 3.0)
#: On a base that moves by such a size sensors lack this share of it by themselves, as on a walker's arm; of
#: what is lacking anyhow this share is new at each instant.
_OWN_SHARE, _NEW_SHARE = 0.25, 0.3
#: For how long it lasts [s]: a base that moves does so at the pace of steps, and what an arm on a base that
#: stands lacks goes with its motion; of those that the smoother tries the middle one and the longest.
_BASE_MEMORY_S, _LACK_MEMORY_S = 0.1, 0.3
#: What lacks of a gyroscope's reading where 1 m/s^2 lacks of an accelerometer's [rad/s]: that of a sensor 0.3 m
#: from its joint that swings two or three times a second.
_RATE_SHARE = 0.2
#: Over how long evidence fades [s]: some strokes, and some steps of a walk.
SHORT_S, LONG_S = 0.5, 10.0


class Bank(NamedTuple):
    """Filters side by side.

    Attributes
    ----------
    base_std, lack_std, new_std : (n_model,) [m/s^2]
        Of each axis of the base's acceleration, of what lasts and of what is new at each instant in a channel of
        an accelerometer.
    share : (n_channel,)
        Of that in each channel: 1, or what makes a gyroscope's of it.
    memory_s : (n_model,) [s]
        For how long either lasts.
    x, P : (n_model, n_state), (n_model, n_state, n_state)
    at : (n_model, n_state)
        Where readings are linearised while the arm rests.
    evidence : (2, n_model)
        Mean logarithm of the density of an instant's readings, over the short and the long memory.
    weight : (n_model,)
    mean, covariance : (n_state,), (n_state, n_state)
        Of the mixture.
    """

    base_std: Floats
    lack_std: Floats
    new_std: Floats
    share: Floats
    memory_s: Floats
    x: Floats
    P: Floats
    at: Floats
    evidence: Floats
    weight: Floats
    mean: Floats
    covariance: Floats


def bank_of(of: Observation, x: Floats, P: Floats, base: bool) -> Bank:
    """Return filters that begin with the same state and covariance, but for what they hold their model to lack.

    Parameters
    ----------
    of : Observation
        With the acceleration of a base and with what the model lacks.
    x, P
        Without them: the state's beginning.
    base : bool
        The base may move.
    """
    sizes = np.array(_SIZES)
    base_std = np.concatenate([0.0 * sizes, sizes]) if base else 0.0 * sizes
    lack_std = np.concatenate([sizes, _OWN_SHARE * sizes]) if base else sizes
    known, n_model = len(x), len(lack_std)
    size = known + 3 + 3 * of.link.size
    means, covariances = np.zeros((n_model, size)), np.zeros((n_model, size, size))
    means[:, :known], covariances[:, :known, :known] = x, P
    share = np.repeat(np.where(of.turning, _RATE_SHARE, 1.0), 3)
    for entry in range(3):
        covariances[:, of.base_column + entry, of.base_column + entry] = base_std**2
    for channel, part in enumerate(share.tolist()):
        covariances[:, of.lack_column + channel, of.lack_column + channel] = (part * lack_std) ** 2
    new_std = _NEW_SHARE * np.maximum(base_std, lack_std)
    weight, evidence = np.full(n_model, 1.0 / n_model), np.zeros((2, n_model))
    bank = Bank(
        base_std,
        lack_std,
        new_std,
        share,
        np.where(base_std > 0.0, _BASE_MEMORY_S, _LACK_MEMORY_S),
        means,
        covariances,
        means.copy(),
        evidence,
        weight,
        np.zeros(size),
        np.zeros((size, size)),
    )
    mix(bank)
    return bank


@compiled
def advance(of: Observation, room: Room, course: Course, bank: Bank, taken: Taken, still: bool) -> None:
    """Carry all filters on to instant 1 of a course of two and take in what was read there.

    Where the arm is ``still`` the readings say nothing of how much is lacking, for that rests with it.
    """
    # the caller keeps them
    of, room, course, bank, taken = borrowed(of), borrowed(room), borrowed(course), borrowed(bank), borrowed(taken)
    n_model, size = bank.x.shape
    log_density, worst = np.empty(n_model), 0.0
    for i in range(n_model):
        x, P = bank.x[i], bank.P[i]
        own = Course(
            course.dt,
            course.readings,
            course.present,
            course.noise + (bank.share * bank.new_std[i]) ** 2,
            course.wander,
            course.push,
            course.jolt,
            course.doubt,
            course.rest,
            course.rate,
            bank.base_std[i],
            bank.share * bank.lack_std[i],
            bank.memory_s[i],
        )
        predict(of, own, 1, x, P)
        log_density[i] = 0.0
        if course.present[1]:
            if not still:
                bank.at[i] = x
            log_density[i] = take_robustly(of, room, own, bank.at[i], x, P, taken)
        if still:
            hold(own, 1, x, P, taken)
        if math.isfinite(log_density[i]) and math.isfinite(x.sum()) and math.isfinite(P.sum()):
            worst = min(worst, log_density[i])
        else:  # it has lost itself, and begins again as what is known
            x[:], P[:], log_density[i] = bank.mean, bank.covariance, np.nan
    for i in range(n_model):
        if not math.isfinite(log_density[i]):
            log_density[i] = worst
    if course.present[1] and not still:
        weigh(bank, log_density, course.dt)
    mix(bank)


@compiled
def take_robustly(
    of: Observation, room: Room, course: Course, at: Floats, x: Floats, P: Floats, taken: Taken
) -> float:
    """Take in the readings of instant 1, sensor by sensor; return the logarithm of their density."""
    observe(of, room, at, taken.miss[: course.noise.size], taken.slope)
    before_x, before_P = x.copy(), P.copy()
    missed, total, density = np.empty(3), np.empty(3), 0.0
    for s in range(course.noise.size // 3):
        before_x[:], before_P[:] = x, P
        squared, weight = 0.0, 1.0
        for again in range(2):
            for c in range(3):
                channel = 3 * s + c
                columns, n_column, slope = of.columns[channel], of.n_column[channel], taken.slope[channel]
                miss = course.readings[1, channel] - taken.miss[channel]
                for b in range(n_column):
                    miss -= slope[columns[b]] * (x[columns[b]] - at[columns[b]])
                variance = course.noise[channel]
                if again == 1:
                    variance += total[c] * (1.0 / weight - 1.0)
                missed[c] = miss
                variance = take(x, P, slope, columns, n_column, miss, variance, taken.gain[channel])
                if again == 0:
                    total[c] = variance
                    squared += miss * miss / variance
                    density -= 0.5 * math.log(variance)
            weight = (FREEDOM + 3.0) / (FREEDOM + squared)
            if weight >= 1.0 or again == 1:
                break
            x[:], P[:] = before_x, before_P
        density -= 0.5 * (FREEDOM + 3.0) * math.log(1.0 + squared / FREEDOM)
    return density


@compiled
def weigh(bank: Bank, log_density: Floats, dt: float) -> None:
    """Weigh the filters anew by how probable each held the readings of an instant to be, (n_model,)."""
    behind = np.zeros(log_density.size)
    for memory in range(2):
        kept = math.exp(-dt / (SHORT_S if memory == 0 else LONG_S))
        evidence = bank.evidence[memory]
        evidence[:] = kept * evidence + (1.0 - kept) * log_density
        behind = np.minimum(behind, evidence - evidence.max())
    bank.weight[:] = np.exp((behind - behind.max()) * SHORT_S / dt)
    bank.weight[:] /= bank.weight.sum()


@compiled
def mix(bank: Bank) -> None:
    """Fill in mean and covariance of the mixture."""
    bank.mean[:], bank.covariance[:] = 0.0, 0.0
    size = bank.mean.size
    for i in range(bank.weight.size):
        bank.mean[:] += bank.weight[i] * bank.x[i]
    for i in range(bank.weight.size):
        if bank.weight[i] > 0.0:
            off = bank.x[i] - bank.mean
            for a in range(size):
                for b in range(size):
                    bank.covariance[a, b] += bank.weight[i] * (bank.P[i, a, b] + off[a] * off[b])


@compiled
def ahead(mean: Floats, covariance: Floats, steps: Floats, states: Floats, variances: Floats) -> None:
    """Fill in where joints of known acceleration are some times later.

    Parameters
    ----------
    mean, covariance
        Of the state.
    steps : (n,) [s]
    states, variances : (n, 3 n_joint + n_channel), (n, n_joint)
        The state's beginning, and the variances of the angles.
    """
    n = variances.shape[1]
    for k in range(steps.size):
        h = steps[k]
        states[k] = mean[: states.shape[1]]
        for j in range(n):
            q = 3 * j
            states[k, q] += h * mean[q + 1] + 0.5 * h * h * mean[q + 2]
            states[k, q + 1] += h * mean[q + 2]
            slope = (1.0, h, 0.5 * h * h)
            variances[k, j] = 0.0
            for a in range(3):
                for b in range(3):
                    variances[k, j] += slope[a] * slope[b] * covariance[q + a, q + b]


def sizes_in(bank: Bank) -> tuple[float, float]:
    """Return what the model lacks of a reading, and by how much its base accelerates, weighed [m/s^2]."""
    return float(bank.weight @ bank.lack_std), float(bank.weight @ bank.base_std)
