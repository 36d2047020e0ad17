"""The motion along which readings are linearised: smoothed, without the noise in its accelerations.

A smoother that holds accelerations to nothing follows the noise of each reading with them, and their noise is then
in the slopes of the readings. The sum of squared slopes is information: of a link that hardly accelerates, noise
alone seems to show the angle. (Errors in variables; put right by *regression calibration*, which takes for a
slope what is most probable of it given what was seen: R. J. Carroll et al., *Measurement Error in Nonlinear
Models*, 2006, ch. 4.) Readings are linear in accelerations, so that where the passes converge, only what is
thought to be known changes, not what is predicted.
"""

import numpy as np
from scipy.ndimage import uniform_filter1d

from arm.model import Floats
from limbcal.compiled import borrowed, compiled
from tracking.model.course import Course
from tracking.model.expected_readings import Room, add_information, observe
from tracking.model.observation import Observation

#: Over how long an acceleration is compared with its mean [s].
_WINDOW_S = 0.128
#: A spread about the mean is motion where it is this many times the noise's: by chance that of 32 instants is
#: beyond it once in 1 500.
_ABOVE = 2.0


def calm(states: Floats, noise: Floats, dt_s: float) -> Floats:
    """Return states with the accelerations that are most probable if those given are noisy.

    As J.-S. Lee does with pictures (*Digital image enhancement and noise filtering by use of local statistics*,
    1980): in each window the mean, and of what differs from it the share that noise does not explain.

    Parameters
    ----------
    states : (n, n_state)
        Smoothed, every third of the first 3 n_joint an acceleration.
    noise : (n, n_joint)
        Variance of the accelerations' noise, see `acceleration_noise`.
    dt_s : float
        From instant to instant.
    """
    accelerations = slice(2, 3 * noise.shape[1], 3)
    ddq = states[:, accelerations]
    size = 1 + 2 * round(0.5 * _WINDOW_S / dt_s)
    mean = uniform_filter1d(ddq, size, axis=0, mode="nearest")
    spread = uniform_filter1d(np.square(ddq - mean), size, axis=0, mode="nearest")
    share = 1.0 - _ABOVE * noise / np.maximum(spread, _ABOVE * noise)
    calmed = states.copy()
    calmed[:, accelerations] = mean + share * (ddq - mean)
    return calmed


@compiled
def acceleration_noise(of: Observation, room: Room, course: Course, states: Floats) -> Floats:
    """Return the variance with which an instant's readings alone show the accelerations, (n, n_joint).

    Parameters
    ----------
    of : Observation
    room : Room
    course : Course
        The readings' variances.
    states : (n, n_state)
        Where the arm is.
    """
    of, room, course = borrowed(of), borrowed(room), borrowed(course)  # the caller keeps them
    n_joint, n_channel = course.push.size, course.noise.size
    noise = np.empty((states.shape[0], n_joint))
    reading, slopes = np.empty(n_channel), np.zeros((n_channel, states.shape[1]))
    for k in range(states.shape[0]):
        observe(of, room, states[k], reading, slopes)
        A = 1e-6 * np.eye(n_joint)  # what no sensor feels is nothing but noise
        add_information(of, course.noise, slopes, A)
        noise[k] = np.diag(np.linalg.inv(A))
    return noise
