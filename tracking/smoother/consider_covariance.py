r"""How well constants are known where errors of readings are not independent, and what angles have of that.

Lengths, mountings, offsets and clocks are constants of a recording. The smoother's covariance of them, P, counts
the readings as the model has their errors. Where these last longer or are larger, stretches of the recording say
different things of the same constants. With the innovations e of a filter that holds the constants, their
variances S and slopes G, the score and the information of a stretch B are

.. math:: r_B = \sum_{k \in B} G_k^T S_k^{-1} e_k, \qquad I_B = \sum_{k \in B} G_k^T S_k^{-1} G_k,

and at the most probable constants the score's covariance is I_B - I_B P I_B if the model is right. The dispersion

.. math:: \varphi = \sum_B r_B^T P r_B / \sum_B \mathrm{tr}\, P (I_B - I_B P I_B)

is then 1 on average (R. T. Birge, *The calculation of errors by the method of least squares*, 1932; P. McCullagh,
J. A. Nelder, *Generalized Linear Models*, 1989, ch. 9). Where it is larger, what readings say of constants counts
1/phi, and what was known before counts as it did (quasi-likelihood): with the prior's covariance C, and the score
g and the information I of all readings where the constants were held before, they move by P* g / phi and have the
covariance

.. math:: P^* = (C^{-1} + I / \varphi)^{-1}.

The angles with which the recording begins are among them: what was known of them was not read either. Were they
left to the filter, a given angle would count 1/phi for how a sensor is turned, and gravity would not tell it.

The motion is the most probable one with the constants there. Of its covariance, J P* J^T is the constants' part,
with its response J to them (consider parameters; S. F. Schmidt, *Application of state-space methods to navigation
problems*, 1966); the rest is that with constants held.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from tracking.model.observation import ABSENT, MOUNTING, Observation
from tracking.smoother.innovations import fill_innovations
from tracking.smoother.linear_response import fill_misses, respond
from tracking.smoother.linearised import Linearised

#: Length of a stretch, in times that what the model lacks lasts: errors in two stretches have nothing in common.
STRETCH_MEMORIES = 10.0


class Considered(NamedTuple):
    """What is known of the constants.

    Attributes
    ----------
    columns : (n_constant,)
        Where they are in the state.
    dispersion : float
        At least 1.
    moved : (n_constant,)
        From where they were held before the first reading.
    covariance : (n_constant, n_constant)
    variance : (n, 3 n_joint)
        The constants' part in that of q, dq, ddq of every joint.
    """

    columns: NDArray[np.intp]
    dispersion: float
    moved: Floats
    covariance: Floats
    variance: Floats

    def held(self, x0: Floats, P0: Floats) -> tuple[Floats, Floats]:
        """Return state and covariance before the first reading with the constants where they were found."""
        return x0 + _shift(P0, self.columns, self.moved), _without(P0, self.columns)

    def added_to(self, P: Floats, free: Floats) -> Floats:
        """Return the covariance after some reading, with the constants' part.

        Parameters
        ----------
        P, free : (n_state, n_state)
            With constants held, and with them free as before the first reading.
        """
        response = _regression(free, self.columns)
        more: Floats = response.T @ self.covariance @ response
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
    """Return what is known of the constants of a recording.

    Parameters
    ----------
    problem : Linearised
    memory_s : float
        For how long what the model lacks lasts.
    """
    columns = constants(problem.of, problem.P0)
    sought = np.concatenate([columns, _first_angles(problem)])
    units = np.sqrt(problem.P0[sought, sought])
    before = problem.P0[np.ix_(sought, sought)] / np.outer(units, units)
    miss, precision, slopes = slopes_of(problem, sought, units)
    length = max(1, round(STRETCH_MEMORIES * memory_s / problem.course.dt))
    begins = np.arange(0, max(1, len(miss) - length // 2), length)  # the last one is no shorter than half of one
    score = np.add.reduceat(np.einsum("kci,kc->ki", slopes, miss * precision), begins, axis=0)
    information = np.add.reduceat(np.einsum("kci,kc,kcj->kij", slopes, precision, slopes), begins, axis=0)
    known = posterior(before, information.sum(axis=0))
    factor = dispersion(score - information @ (known @ score.sum(axis=0)), information, known)
    known = posterior(before, information.sum(axis=0) / factor)
    own = slice(0, len(columns))
    moved, known, unit = (known @ score.sum(axis=0))[own] / factor, known[own, own], units[own]
    response = responses_of(problem, columns, unit)
    variance = np.einsum("kjp,pq,kjq->kj", response, known, response)
    return Considered(columns, factor, unit * moved, known * np.outer(unit, unit), variance)


def _first_angles(problem: Linearised) -> NDArray[np.intp]:
    """Return where the state has joints of which it is not known exactly where they begin."""
    angles = 3 * np.arange(problem.n_joint, dtype=np.intp)
    return angles[problem.P0[angles, angles] > 0.0]


def posterior(before: Floats, information: Floats) -> Floats:
    """Return the covariance of constants from that before and what readings say; neither need have an inverse."""
    found = before @ np.linalg.inv(np.eye(len(before)) + information @ before)
    covariance: Floats = 0.5 * (found + found.T)
    return covariance


class Slopes(NamedTuple):
    """How readings depend on constants, in units of what they may be off before the first reading.

    Attributes
    ----------
    miss, precision : (n, n_row)
        Innovations with the constants held where they were before, and one over their variances.
    slopes : (n, n_row, n_constant)
        By how much less they miss for each unit.
    """

    miss: Floats
    precision: Floats
    slopes: Floats


def slopes_of(problem: Linearised, columns: NDArray[np.intp], unit: Floats) -> Slopes:
    """Return how readings depend on constants at some columns (n_constant,), with their units."""
    held = problem._replace(P0=_without(problem.P0, columns))
    miss, total = _innovations(held)
    more = np.empty((*miss.shape, len(columns)))
    errors, noise = _moved(problem, columns, unit), np.zeros_like(more)
    fill_misses(held.of, held.room, held.course, held.at, held.P0.copy(), errors, noise, more)
    return Slopes(miss, 1.0 / total, -more)


def responses_of(problem: Linearised, columns: NDArray[np.intp], unit: Floats) -> Floats:
    """Return by how much the smoothed q, dq, ddq of every joint move for each unit, (n, 3 n_joint, n_constant)."""
    held = problem._replace(P0=_without(problem.P0, columns))
    n, rows = len(problem.at), problem.course.noise.size + problem.n_joint
    response = np.empty((n, 3 * problem.n_joint, len(columns)))
    errors, noise = _moved(problem, columns, unit), np.zeros((n, rows, len(columns)))
    respond(held.of, held.room, held.course, held.at, held.P0.copy(), errors, noise, response)
    return response


def _moved(problem: Linearised, columns: NDArray[np.intp], unit: Floats) -> Floats:
    """Return by how much the state before the first reading moves for each unit, (n_state, n_constant)."""
    return np.ascontiguousarray(_shift(problem.P0, columns, np.diag(unit)).T)


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


def _regression(P: Floats, columns: NDArray[np.intp]) -> Floats:
    """Return by how much all entries of a state go with its constants, (n_constant, n_state)."""
    own = P[np.ix_(columns, columns)]
    unit = np.sqrt(np.diag(own))
    found: Floats = np.linalg.lstsq(own / np.outer(unit, unit), P[columns] / unit[:, None], rcond=None)[0]
    return found / unit[:, None]


def _without(P: Floats, columns: NDArray[np.intp]) -> Floats:
    """Return the covariance of a state whose constants are known."""
    held = P - P[:, columns] @ _regression(P, columns)
    held[columns, :], held[:, columns] = 0.0, 0.0
    known: Floats = 0.5 * (held + held.T)
    return known


def _shift(P: Floats, columns: NDArray[np.intp], by: Floats) -> Floats:
    """Return by how much a state moves whose constants do (…, n_constant): with them what goes with them."""
    step: Floats = by @ _regression(P, columns)
    step[..., columns] = by
    return step


def _innovations(problem: Linearised) -> tuple[Floats, Floats]:
    rows = problem.course.noise.size + problem.n_joint
    miss, total = np.empty((2, len(problem.at), rows))
    x, P = problem.x0.copy(), problem.P0.copy()
    fill_innovations(problem.of, problem.room, problem.course, problem.at, x, P, miss, total)
    return miss, total
