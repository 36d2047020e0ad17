"""Sensors that are late, and sensors that are loose: to first order, what either does to the readings.

Along the most probable motion, readings have a slope by the lateness of their clock, which is their rate with its
sign reversed, and by the play of their sensor. One that is loose is turned about the axis of its link's joint, to
one side or the other as that turns one way or the other: by its play times the sign of the joint's speed, which
is known as well as the speed. Gravity makes both much alike, since what it is read as changes where the joint has
a speed: a sine and its sign have four fifths of their power in common. So either is judged beside the other.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from arm.model import Floats
from tracking.model.clocks import CLOCK_STD_S, moved_back
from tracking.model.initial_state import MountingPrior
from tracking.smoother.linearised import Linearised
from tracking.smoother.smoothing_pass import Pass

#: How loose a sensor is [rad]: as much as a careful mounting may turn it.
PLAY_STD_RAD = MountingPrior().turn_rad


class SensorEffects(NamedTuple):
    """Effects of unknown sizes on the readings, to first order.

    Attributes
    ----------
    slopes : (n_effect, n, n_channel)
        Of the readings by the size of each [1/s of a clock, 1/rad of a play, times the unit of a reading].
    prior_std : (n_effect,)
        Of its size [s or rad].
    """

    slopes: Floats
    prior_std: Floats


def late_and_loose(
    problem: Linearised, found: Pass, housing: NDArray[np.intp], asked: tuple[int, ...]
) -> SensorEffects:
    """Return the effects of clocks, in the order asked for, and then those of sensors that are loose.

    Parameters
    ----------
    problem : Linearised
    found : Pass
        Of it, with variances.
    housing : (n_triad,)
        The sensor that each triad belongs to: a gyroscope is late and loose with its accelerometer.
    asked : tuple of int
        Sensors whose clocks may differ.
    """
    own = np.repeat(housing, 3)
    resting = np.zeros(len(housing))
    late = -moved_back(problem.course, problem.course.readings, resting).drift
    loose = _play_slopes(problem, found)
    of_clocks = [late * (own == sensor) for sensor in asked]
    of_plays = [loose * (own == sensor) for sensor in np.unique(housing)]
    of_plays = [one for one in of_plays if one.any()]
    stds = np.repeat([CLOCK_STD_S, PLAY_STD_RAD], [len(of_clocks), len(of_plays)])
    return SensorEffects(np.array([*of_clocks, *of_plays]), stds)


def _play_slopes(problem: Linearised, found: Pass) -> Floats:
    """Return the slopes of all readings by the play of their sensor, (n, n_channel).

    They are zero of a sensor on a link that slides, and of an AC-coupled one, which does not read what it feels.
    """
    of, readings = problem.of, problem.course.readings
    slopes = np.zeros_like(readings)
    for s, link in enumerate(of.link.tolist()):
        if not of.chain.revolute[link] or of.corner[s] > 0.0:
            continue
        speed, variance = found.states[:, 3 * link + 1], found.variance[:, 3 * link + 1]
        side = erf(speed / np.sqrt(2.0 * np.maximum(variance, np.finfo(np.float64).tiny)))  # the sign's mean
        own = slice(3 * s, 3 * s + 3)
        turned = np.cross(readings[:, own] / of.scale[s], of.rotation[s, 2])  # a joint turns about its link's z
        slopes[:, own] = of.scale[s] * turned * side[:, None]
    return slopes


def information_of(problem: Linearised, found: Pass, effects: SensorEffects) -> Floats:
    """Return the information of all readings on the sizes of effects, (n_effect, n_effect).

    Along the motion smoothing errors are linear in the readings, so that a pass over readings less a unit of an
    effect shows what it does to them; the motion and what the model lacks take up the rest.
    """
    course, n_channel = problem.course, problem.course.noise.size
    there = course.present[:, None]
    taken_up = np.empty_like(effects.slopes)
    for k, (slope, unit) in enumerate(zip(effects.slopes, effects.prior_std, strict=True)):
        less = problem._replace(course=course._replace(readings=course.readings - unit * slope))
        after = less.smoothed(with_variance=False)[0]
        taken_up[k] = (found.error - after.error)[:, :n_channel] * there / unit
    information: Floats = np.einsum("akc,bkc->ab", effects.slopes, taken_up)
    return 0.5 * (information + information.T)
