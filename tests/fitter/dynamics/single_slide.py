"""A problem of one slide, whose motion from any start under any force is known in closed form."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from arm.model import Arm, Control, Joint, Link
from arm.structural_parameters import structural_parameters
from fitter.dynamics.prior_and_limits import Allowed
from fitter.dynamics.shooting import Shooting
from fitter.dynamics.shooting_problem import ShootingProblem
from fitter.dynamics.shooting_windows import ShootingWindow

#: Mass [kg], force [N], step [s] and samples of a window.
MASS, FORCE, DT_S, N = 2.0, 3.0, 0.01, 50
SLIDE = Arm("slide", (Joint(type="prismatic", link=Link(MASS)),), gravity_m_s2=(0.0, 0.0, 0.0), control=Control())
BASE = structural_parameters(SLIDE)
PLACE = BASE.names.index("m1")


def positions(mass, start, dt_s=DT_S):
    """Return the slide's positions from a start (position, velocity) under the force: uniform acceleration."""
    t = dt_s * np.arange(N)
    return (start[0] + start[1] * t + 0.5 * FORCE / mass * t**2)[:, None]


def window(mass=MASS, start=(0.1, -0.2), dt_s=DT_S, **changes):
    seen = positions(mass, start, dt_s)
    return ShootingWindow(0, dt_s, np.full((N, 1), FORCE), seen, np.array(start), **changes)


def problem(windows, pool: ThreadPoolExecutor, x0=MASS, **changes):
    """Return the problem whose one unknown is the mass."""

    def complete(x):
        values = np.zeros(len(BASE.names))
        values[PLACE] = x[0]
        return values

    given = {"allowed": Allowed(), "own_noise": 0.0, "iterations": 40} | changes
    return ShootingProblem(
        Shooting(SLIDE, BASE), windows, complete, np.array([x0]), np.ones(1), pool=pool, **given
    )
