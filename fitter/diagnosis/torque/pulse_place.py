"""The likeliest start, duration and size of a pulse near a place."""

from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, NEGLIGIBLE, SETTLED
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Rows
from fitter.diagnosis.torque.kalman import Filter, response
from fitter.diagnosis.torque.pulse_column import RowGrid, column_of
from fitter.diagnosis.torque.student_ratio import likeliest_ratio
from limbcal.compiled import compiled

#: Innovations of a pulse below this part of the largest are none: a thousand of them add less than is settled.
_SETTLED_RESPONSE = SETTLED**2


class _Filtered(NamedTuple):
    """A residual's standardised innovations, and the filter of a pulse beside them, as compiled code takes it."""

    e: Floats
    F: Floats
    C: Floats
    gain: Floats
    S: Floats
    known: NDArray[np.bool_]
    nu: float


def likeliest_place(
    rows: Rows, kalman: Filter, nu: float, r: Floats, near: tuple[float, float], form: str
) -> tuple[float, float, float]:
    """Return start, duration and size of a pulse near a start and a duration [s].

    A large pulse is many standard deviations off wherever its place is not exact, and Student's likelihood has
    maxima elsewhere. So it is sought with the noise as large as what is off there first (graduated
    non-convexity: Blake and Zisserman 1987), and from either place with the noise as it is.

    Parameters
    ----------
    rows : Rows
    kalman : Filter
        With the weights of the rows without the pulse.
    nu : float
        Degrees of freedom.
    r : (n,) [N m]
        Residual with the pulse.
    near : (float, float) [s]
    form : str
    """
    grid = RowGrid.of(rows)
    filtered = _Filtered(kalman.innovations(r), kalman.F, kalman.C, kalman.gain, kalman.S, kalman.known, float(nu))
    is_bell = form == "bell"

    def placed(place: tuple[float, float], x: Floats) -> tuple[float, float]:
        return place[0] + place[1] * float(x[0]), place[1] * float(np.exp(x[1]))

    def at(place: tuple[float, float], noise: float) -> tuple[float, float, float]:
        return _ratio_at(filtered, grid, *place, is_bell, noise)

    def sought(near: tuple[float, float], noise: float) -> tuple[float, float]:
        low, high = np.log([rows.step_s / near[1], LONGEST_PULSE_S / near[1]])
        best = scipy.optimize.minimize(  # type: ignore[call-overload]
            lambda x: -at(placed(near, x), noise)[0],
            np.zeros(2),
            method="Nelder-Mead",
            bounds=scipy.optimize.Bounds([-1.0, min(low, 0.0)], [1.0, max(high, 0.0)]),
            options={
                "initial_simplex": [[0.0, 0.0], [0.25, 0.0], [0.0, 0.25]],
                "xatol": NEGLIGIBLE,
                "fatol": NEGLIGIBLE,
            },
        )
        return placed(near, best.x)

    missed = at(near, 1.0)[2]
    begun = [near, sought(near, missed)] if missed > EQUAL_SIGMAS else [near]
    place = max((sought(one, 1.0) for one in begun), key=lambda one: at(one, 1.0)[0])
    return *place, at(place, 1.0)[1]


@compiled
def _ratio_at(
    filtered: _Filtered, grid: RowGrid, start_s: float, duration_s: float, is_bell: bool, noise: float
) -> tuple[float, float, float]:
    """Return the log likelihood ratio of a pulse at a place, its size, and the rms of what it misses there.

    The standardised innovations have a standard deviation of ``noise`` instead of one.
    """
    first, column = column_of(grid, grid.settling_s, start_s, duration_s, is_bell)
    if len(column) == 0:  # past the trial's ends there is nothing that a place could miss
        return 0.0, 0.0, 0.0
    # What a pulse did to the angles stays: of quiet angles the rows behind it tell most.
    e, F, C, gain, S, known, nu = filtered
    s = response(F, C, gain, S, known, column, first, _SETTLED_RESPONSE)
    own = e[first : first + len(s)] / noise
    s = s / noise
    ratio, size = likeliest_ratio(own, s, nu)
    near = own[: len(column)] - size * s[: len(column)]
    return ratio, size, float(np.sqrt(np.mean(near**2)))
