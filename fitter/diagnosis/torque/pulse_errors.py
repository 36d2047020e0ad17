"""How well a pulse's start, duration and size are known, by Fisher's information of Student's location."""

import numpy as np

from arm.model import Floats
from fitter.diagnosis.least_squares import TINY
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Rows
from fitter.diagnosis.torque.kalman import Filter
from fitter.diagnosis.torque.pulse import DURATION_RATIO
from fitter.diagnosis.torque.pulse_column import in_rows

#: Start, duration and size by start, end and size.
_OF_ENDS = np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def place_errors(
    rows: Rows,
    kalman: Filter,
    nu: float,
    place: tuple[float, float, str],
    size: float,
    unseen_s: tuple[float, float],
    part: float = 0.05,
) -> tuple[Floats, float]:
    """Return the covariance of start, duration and size, (3, 3), and the logarithm of the likelihood's volume.

    The volume is in units of the places that are sought, times the unit of the size, by Laplace.

    Parameters
    ----------
    rows : Rows
    kalman : Filter
        With the weights of the rows without the pulse.
    nu : float
        Degrees of freedom.
    place : (float, float, str)
        Start and duration [s], and form.
    size : float [N m]
    unseen_s : (float, float) [s]
        For how long nothing tells about start and end.
    part : float
        Slopes are taken over this part of the duration.
    """
    start_s, duration_s, form = place
    step = part * duration_s
    starts = [in_rows(rows, start_s + s, duration_s - s, form) for s in (step, -step)]
    ends = [in_rows(rows, start_s, duration_s + s, form) for s in (step, -step)]
    slopes = [size * (ahead - behind) / (2.0 * step) for ahead, behind in (starts, ends)]
    # Of an end that is unseen nothing tells, though the rows beside it seem to: the likelihood is flat.
    seen = [slope * (span == 0.0) for slope, span in zip(slopes, unseen_s, strict=True)]
    J = np.stack([kalman.innovations(column) for column in [*seen, in_rows(rows, *place)]], axis=1)
    # There it is uniform, else within the longest duration.
    spans = np.array([span or LONGEST_PULSE_S for span in unseen_s])
    information = (nu + 1.0) / (nu + 3.0) * J.T @ J + np.diag([*(12.0 / spans**2), TINY])
    sought = rows.step_s * duration_s * float(np.log(DURATION_RATIO))
    volume = 1.5 * np.log(2.0 * np.pi) - 0.5 * np.linalg.slogdet(information)[1] - np.log(sought)
    return np.asarray(_OF_ENDS @ np.linalg.inv(information) @ _OF_ENDS.T), float(volume)
