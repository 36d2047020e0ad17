"""The bundle fit's cost of a geometry by itself: marker places and angles are projected out.

Variable projection (Golub and Pereyra 1973): of a geometry counts what it costs with the places and angles that
suit it best. These are found by a few Gauss-Newton steps from those of a geometry nearby, in which each frame's
angles are eliminated as in the bundle fit (`normal_equations`).
"""

import numpy as np

from arm.marker_kinematics import MarkerChain, Slopes, slopes_room
from arm.model import Floats
from fitter.limb.inverse_kinematics import solve_frame
from fitter.limb.marker_observations import AnglePrior, Frames
from fitter.limb.normal_equations import bundle_cost, eliminate
from limbcal.compiled import compiled

#: As in the bundle fit: damping of the first step; what a step that costs more, and one that costs less, multiply
#: it by; and the relative gain below which there is no other.
_FIRST_DAMPING, _MORE, _LESS, _CONVERGED = 1e-3, 30.0, 0.2, 1e-7


def projected_cost(
    chain: MarkerChain,
    frames: Frames,
    share: Floats,
    q: Floats,
    variance: Floats,
    angles: AnglePrior,
    about: Floats,
    information: Floats,
    steps: tuple[int, int],
) -> float:
    """Return the cost of a chain's geometry, without the prior of the geometry itself.

    Parameters
    ----------
    chain : MarkerChain
        Its ``place`` (m, 3) is where places begin, and is changed to where they end.
    frames : Frames
    share : (n_frame,)
    q : (n_frame, n_joint)
        Where angles begin, changed to where they end.
    variance : (m,) [m²]
    angles : AnglePrior
    about, information : (m, 3) [m], (3 m,) [1/m²]
        The prior of places.
    steps : (int, int)
        Of each frame's angles by themselves, then of places and angles together.
    """
    n, n_place = q.shape[1], 3 * len(about)
    gain, shift = np.empty((len(q), n, n_place)), np.empty((len(q), n))
    S, b = np.empty((1, n_place, n_place)), np.empty((1, n_place))
    return float(
        _project(
            chain,
            frames,
            share,
            q,
            variance,
            angles,
            about,
            information,
            *steps,
            slopes_room(n, 0),
            gain,
            shift,
            S,
            b,
        )
    )


@compiled
def _project(
    chain: MarkerChain,
    frames: Frames,
    share: Floats,
    q: Floats,
    variance: Floats,
    angles: AnglePrior,
    about: Floats,
    information: Floats,
    own_steps: int,
    joint_steps: int,
    room: Slopes,
    gain: Floats,
    shift: Floats,
    S: Floats,
    b: Floats,
) -> float:
    nothing, part = np.empty((0, 2), dtype=np.int64), np.zeros(q.shape[0], dtype=np.int64)
    place, tried, n_place = chain.place.copy(), np.empty_like(q), b.shape[1]
    if own_steps:
        for k in range(q.shape[0]):
            solve_frame(chain, frames, k, variance, angles, own_steps, room, q[k])
    damping = _FIRST_DAMPING
    cost = bundle_cost(chain, frames, q, variance, angles, share, room) + _prior(place, about, information)
    for _ in range(joint_steps):
        eliminate(
            chain, frames, q, variance, angles, share, nothing, 1e-2 * damping, part, room, gain, shift, S, b
        )
        H, h = S[0], b[0]
        for i in range(n_place):
            H[i, i] = (1.0 + damping) * (H[i, i] + information[i])
            h[i] -= information[i] * (place[i // 3, i % 3] - about[i // 3, i % 3])
        step = np.linalg.solve(H, h)
        for i in range(n_place):
            chain.place[i // 3, i % 3] = place[i // 3, i % 3] + step[i]
        for k in range(q.shape[0]):
            tried[k] = q[k] + shift[k] - np.dot(gain[k], step)
        found = bundle_cost(chain, frames, tried, variance, angles, share, room)
        found += _prior(chain.place, about, information)
        if found < cost:
            gained = cost - found
            q[:], place[:], cost = tried, chain.place, found
            damping *= _LESS
            if gained < _CONVERGED * abs(cost):
                break
        else:
            chain.place[:] = place
            damping *= _MORE
    return cost


@compiled
def _prior(place: Floats, about: Floats, information: Floats) -> float:
    total = 0.0
    for i in range(information.size):
        total += information[i] * (place[i // 3, i % 3] - about[i // 3, i % 3]) ** 2
    return total
