r"""What is wrong with a geometry because of what is wrong with the motion that it was learnt from.

A tracker that knows how well it knows a motion gives draws of it. To each draw belongs a residual of the tip,
:math:`r_b = r^*_b - (f(q_b) - f(q_{b,rest}))`, and to first order the answer that belongs to it lies

.. math:: \delta\theta_b = (J^T J)^{-1} J^T (r_b - r)

from the one that was found. The draws share what the motions shared, such as a sensor's offset, so their scatter
is the covariance of the answer, however strongly its errors hang together within a motion and between motions.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import tip_position
from arm.model import Arm, Floats
from fitter.data.first_rest import first_rest
from fitter.data.measured_tip import measured_tip
from fitter.data.trial import Trial
from fitter.kinematics.tip_basis import geometry_of, with_geometry

_STEP = 1e-5


@dataclass(frozen=True)
class DrawnGeometry:
    """A geometry as it may be.

    Attributes
    ----------
    departures : (n_draw, n_joint, 5)
        From the geometry that was found; zero where it is not determined.
    residual_square : (n_draw,) [m^2]
        What the draws' own answers leave of the tip's displacement, squared and summed.
    found : float [m^2]
        And what the geometry that was found leaves of it.
    """

    departures: Floats
    residual_square: Floats
    found: float


def drawn_geometry(arm: Arm, found: Arm, which: NDArray[np.intp], trials: Sequence[Trial]) -> DrawnGeometry | None:
    """Return what the draws of the trials' motions make of a geometry, or None where one has no draws.

    Parameters
    ----------
    arm : Arm
        As its file has it: it says how the tip's sensor sits on its link.
    found : Arm
        With the geometry that was found.
    which : (n_parameter,) int
        What was sought, places in the flattened geometry.
    trials : sequence of Trial
        That it was found from, with tips.
    """
    draws = [trial.draws for trial in trials]
    if not len(which) or not trials or any(one is None for one in draws):
        return None
    n_draw = len(draws[0].q) if draws[0] is not None else 0
    normal, scores = np.zeros((len(which), len(which))), np.zeros((n_draw, len(which)))
    power, residual_square = np.zeros(n_draw), 0.0
    for trial, one in zip(trials, draws, strict=True):
        assert one is not None and trial.tip is not None
        rest = first_rest(trial)
        slopes = _slopes(found, which, trial.q, rest)
        normal += slopes.T @ slopes
        residual = _since(trial.tip, rest) - _since(tip_position(found, trial.q), rest)
        residual_square += float(np.sum(residual**2))
        for b in range(n_draw):
            points = np.zeros((len(trial.q), len(arm.sensors), 3))
            points[:, _tip_sensor(arm)] = one.points[b, :, 0]
            moved = measured_tip(arm, one.q[b], points)
            change = _since(moved, rest) - _since(tip_position(found, one.q[b]), rest) - residual
            scores[b] += change.ravel() @ slopes
            power[b] += np.sum(change**2)
    answers = np.linalg.lstsq(normal, scores.T, rcond=None)[0].T
    departures = np.zeros((n_draw, geometry_of(found).size))
    departures[:, which] = answers
    return DrawnGeometry(
        departures.reshape(n_draw, -1, 5), power - np.einsum("bi,bi->b", scores, answers), residual_square
    )


def _tip_sensor(arm: Arm) -> int:
    assert arm.tip is not None
    return arm.sensor_index(arm.tip.sensor)


def _since(place: Floats, rest: slice) -> Floats:
    return np.asarray(place - place[rest].mean(axis=0), dtype=np.float64)


def _slopes(found: Arm, which: NDArray[np.intp], q: Floats, rest: slice) -> Floats:
    """Return how the tip's displacement changes with the geometry, (3 n_sample, n_parameter)."""
    geometry, slopes = geometry_of(found), np.empty((3 * len(q), len(which)))
    for k, place in enumerate(which):
        ends = []
        for step in (_STEP, -_STEP):
            moved = geometry.copy()
            moved.flat[place] += step
            ends.append(_since(tip_position(with_geometry(found, moved), q), rest))
        slopes[:, k] = ((ends[0] - ends[1]) / (2.0 * _STEP)).ravel()
    return slopes
