r"""How much larger what the model lacks is than the smoother holds, as the sensors' disagreement shows.

What all sensors of an arm lack is held to be as large on each, and to last as long. Play of one sensor, or a link
that bends, goes with the motion instead, and the angles follow it. Each sensor is left out in turn: if the model
is right, the angles q without it differ from those with all by what is then known less (the variance of the
difference of an efficient and another estimate; J. A. Hausman, *Specification tests in econometrics*, 1978),

.. math:: E (q_{-s} - q)^2 = V_{-s} - V.

The ratio of the two, both averaged over the recording, is 1 on average. For each joint the largest one of all
sensors counts: a disagreement of two does not say which of them is right. Where a sensor is the only one of a
link, the angles are hardly known without it, and it says little.
"""

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from tracking.smoother.linearised import Linearised

#: Factor on the noise of a sensor that is left out.
_LEFT_OUT = 1e9
#: Step of a derivative by the variance of what the model lacks, as a share of it.
_STEP = 0.01


def disagreement(problem: Linearised, housing: NDArray[np.intp]) -> Floats:
    """Return by how many times what the model lacks varies more than is held, as each joint shows, (n_joint,).

    Parameters
    ----------
    problem : Linearised
    housing : (n_triad,)
        The sensor that each triad belongs to: a gyroscope is left out with its accelerometer.

    Returns
    -------
    ratio : (n_joint,)
        At least 1, and 1 if there is only one sensor.
    """
    all_in = problem.smoothed()[0]
    angles, variance = problem.angles_of(all_in), problem.angle_variance_of(all_in)
    ratios = [np.ones(problem.n_joint)]
    sensors = np.unique(housing)
    for sensor in sensors if len(sensors) > 1 else []:
        own = np.repeat(housing == sensor, 3)
        doubt = problem.course.doubt * np.where(own, _LEFT_OUT, 1.0)
        without = problem._replace(course=problem.course._replace(doubt=doubt)).smoothed()[0]
        found = np.square(problem.angles_of(without) - angles).mean(axis=0)
        expected = (problem.angle_variance_of(without) - variance).mean(axis=0)
        ratios.append(np.where(expected > 0.0, found / np.where(expected > 0.0, expected, 1.0), 1.0))
    ratio: Floats = np.max(ratios, axis=0)
    return ratio


def variance_by_lack(problem: Linearised) -> Floats:
    """Return the part of the motion's variance that is of what the model lacks of readings, (n, 3 n_joint).

    The smoother weighs readings best for the sizes that it holds, so that its variance grows with one of them as
    if the weights stayed as they are (the envelope theorem): the part is a derivative.
    """
    of, course = problem.of, problem.course
    P0, own = problem.P0.copy(), np.arange(of.lack_column, of.lack_column + course.noise.size)
    P0[own, own] *= 1.0 + _STEP
    larger = problem._replace(course=course._replace(lack_std=course.lack_std * np.sqrt(1.0 + _STEP)), P0=P0)
    before, after = (one.smoothed()[0].variance[:, : 3 * problem.n_joint] for one in (problem, larger))
    part: Floats = np.maximum(after - before, 0.0) / _STEP
    return part
