r"""How well constants are known where errors of readings are not independent, and what angles have of that.

Lengths, mountings, offsets and clocks are constants of a recording. The smoother's covariance of them, P, counts
the readings as the model has their errors. Where these last longer or are larger, stretches of the recording say
different things of the same constants. With the innovations e of a filter that holds the constants, their
variances S and slopes G, the score and the information of a stretch B are

.. math:: r_B = \sum_{k \in B} G_k^T S_k^{-1} e_k, \qquad I_B = \sum_{k \in B} G_k^T S_k^{-1} G_k,

and at the most probable constants the score's covariance is I_B - I_B P I_B if the model is right. The dispersion

.. math:: \varphi = \sum_B r_B^T P r_B / \sum_B \mathrm{tr}\, P (I_B - I_B P I_B)

is then 1 on average (R. T. Birge, *The calculation of errors by the method of least squares*, 1932; P. McCullagh,
J. A. Nelder, *Generalized Linear Models*, 1989, ch. 9). Where it is larger, the readings count 1/phi as many: the
covariance of the constants is P + (phi - 1) P I P with I the sum of the I_B, the *sandwich* (P. J. Huber 1967).
What was known before is not enlarged. An angle has of it J (phi - 1) P I P J^T, with its response J to the
constants (consider parameters; S. F. Schmidt, *Application of state-space methods to navigation problems*, 1966).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from tracking.model.observation import ABSENT, MOUNTING, Observation
from tracking.smoother.innovations import fill_innovations
from tracking.smoother.linearised import Linearised

#: Length of a stretch, in times that what the model lacks lasts: errors in two stretches have nothing in common.
STRETCH_MEMORIES = 10.0


class Considered(NamedTuple):
    """What the constants add to a claim.

    Attributes
    ----------
    columns : (n_constant,)
        Where they are in the state.
    dispersion : float
        At least 1.
    added : (n_constant, n_constant)
        To their covariance.
    variance : (n, n_joint)
        Added to that of the angles.
    """

    columns: NDArray[np.intp]
    dispersion: float
    added: Floats
    variance: Floats

    def added_to(self, P: Floats) -> Floats:
        """Return the covariance (n_state, n_state) after some reading, with what the constants add to it."""
        own = P[np.ix_(self.columns, self.columns)]
        unit = np.sqrt(np.diag(own))
        response = np.linalg.lstsq(own / np.outer(unit, unit), P[self.columns] / unit[:, None], rcond=None)[0]
        more: Floats = response.T @ (self.added / np.outer(unit, unit)) @ response
        return P + 0.5 * (more + more.T)


def constants(of: Observation, P0: Floats) -> NDArray[np.intp]:
    """Return where the state has constants that are not known exactly, (n_constant,).

    The offset of an AC-coupled channel is none: it goes with what was read.
    """
    steady = np.repeat(of.corner == 0.0, 3)
    offsets = 3 * of.chain.revolute.size + np.flatnonzero(steady)
    lengths = of.length_column[of.length_column != ABSENT]
    mountings = np.unique(of.mounting_column[of.mounting_column != ABSENT])[:, None] + np.arange(MOUNTING)
    scales = of.gyro_scale_column[of.gyro_scale_column != ABSENT][:, None] + np.arange(3)
    clocks = np.unique(of.clock_column[of.clock_column != ABSENT])
    columns = np.concatenate([offsets, lengths, mountings.ravel(), scales.ravel(), clocks]).astype(np.intp)
    return columns[P0[columns, columns] > 0.0]


def consider(problem: Linearised, memory_s: float) -> Considered:
    """Return what the constants of a recording add to its claims.

    Parameters
    ----------
    problem : Linearised
    memory_s : float
        For how long what the model lacks lasts.
    """
    columns = constants(problem.of, problem.P0)
    unit = np.sqrt(problem.P0[columns, columns])
    _, x, P = problem.smoothed(with_variance=False)
    known = P[np.ix_(columns, columns)] / np.outer(unit, unit)
    miss, precision, slopes, response = sensitivities(problem, columns, unit)
    error = miss - slopes @ ((x - problem.x0)[columns] / unit)
    length = max(1, round(STRETCH_MEMORIES * memory_s / problem.course.dt))
    begins = np.arange(0, max(1, len(miss) - length // 2), length)  # the last one is no shorter than half of one
    score = np.add.reduceat(np.einsum("kci,kc->ki", slopes, error * precision), begins, axis=0)
    information = np.add.reduceat(np.einsum("kci,kc,kcj->kij", slopes, precision, slopes), begins, axis=0)
    factor = dispersion(score, information, known)
    more = (factor - 1.0) * known @ information.sum(axis=0) @ known
    variance = np.einsum("kjp,pq,kjq->kj", response, more, response)
    return Considered(columns, factor, more * np.outer(unit, unit), variance)


class Sensitivities(NamedTuple):
    """How readings and angles depend on the constants, in units of what they may be off before the first reading.

    Attributes
    ----------
    miss, precision : (n, n_row)
        Innovations with the constants held where they were before, and one over their variances.
    slopes : (n, n_row, n_constant)
        By how much less they miss for each unit.
    response : (n, n_joint, n_constant)
        By how much the smoothed angles move for each.
    """

    miss: Floats
    precision: Floats
    slopes: Floats
    response: Floats


def sensitivities(problem: Linearised, columns: NDArray[np.intp], unit: Floats) -> Sensitivities:
    """Return how readings and angles depend on constants at some columns (n_constant,), with their units."""
    held = _held(problem, columns)
    miss, total = _innovations(held)
    angles = held.angles_of(held.smoothed(with_variance=False)[0])
    slopes, response = np.empty((*miss.shape, len(columns))), np.empty((*angles.shape, len(columns)))
    for j in range(len(columns)):
        moved = _moved(problem, held, columns, unit * (np.arange(len(columns)) == j))
        slopes[:, :, j] = miss - _innovations(moved)[0]
        response[:, :, j] = moved.angles_of(moved.smoothed(with_variance=False)[0]) - angles
    return Sensitivities(miss, 1.0 / total, slopes, response)


def dispersion(score: Floats, information: Floats, known: Floats) -> float:
    """Return by how many times the scores of stretches vary more than the model has it, at least 1.

    Parameters
    ----------
    score, information : (n_stretch, n_constant), (n_stretch, n_constant, n_constant)
        Of each stretch, at the most probable constants.
    known : (n_constant, n_constant)
        Their covariance after all readings.
    """
    found = float(np.einsum("bi,ij,bj->", score, known, score))
    expected = sum(float(np.trace(known @ (one - one @ known @ one))) for one in information)
    return max(1.0, found / expected) if expected > 0.0 else 1.0


def _held(problem: Linearised, columns: NDArray[np.intp]) -> Linearised:
    """Return the problem with its constants held where they were before the first reading."""
    P0 = problem.P0.copy()
    own = P0[np.ix_(columns, columns)]
    unit = np.sqrt(np.diag(own))
    given = np.linalg.lstsq(own / np.outer(unit, unit), P0[columns] / unit[:, None], rcond=None)[0]
    P0 -= (P0[:, columns] / unit) @ given
    P0[columns, :], P0[:, columns] = 0.0, 0.0
    return problem._replace(P0=0.5 * (P0 + P0.T))


def _moved(problem: Linearised, held: Linearised, columns: NDArray[np.intp], by: Floats) -> Linearised:
    """Return the problem with its constants held so far away (n_constant,), and what goes with them before."""
    own = problem.P0[np.ix_(columns, columns)]
    unit = np.sqrt(np.diag(own))
    weight = np.linalg.lstsq(own / np.outer(unit, unit), by / unit, rcond=None)[0]
    step = (problem.P0[:, columns] / unit) @ weight
    step[columns] = by
    return held._replace(x0=held.x0 + step)


def _innovations(problem: Linearised) -> tuple[Floats, Floats]:
    rows = problem.course.noise.size + problem.n_joint
    miss, total = np.empty((2, len(problem.at), rows))
    x, P = problem.x0.copy(), problem.P0.copy()
    fill_innovations(problem.of, problem.room, problem.course, problem.at, x, P, miss, total)
    return miss, total
