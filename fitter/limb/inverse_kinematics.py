"""A limb's joint angles frame by frame: weighted least squares from the angles of the frame before.

Where that ends far from the markers, as at the beginning of a trial or after a gap, it begins anew from several
postures and takes the best. So does one frame in `_ANEW_EVERY` wherever it ends: angles in another minimum,
a forearm turned half about, would be followed from frame to frame. What is better is then followed both ways.
"""

import math

import numpy as np

from arm.marker_kinematics import MarkerChain, Slopes, link_frames, marker_at, slopes_room
from arm.model import Floats
from fitter.limb.frame_equations import frame_equations
from fitter.limb.marker_observations import AnglePrior, Frames
from fitter.limb.normal_equations import t_cost
from limbcal.compiled import compiled

#: Postures that a frame begins anew from.
_STARTS = 24
#: Frames from one that begins anew to the next at the most: to look for others then costs about as much as to
#: follow.
_ANEW_EVERY = 2 * _STARTS
#: Angles of successive frames that differ by more may be of different minima [rad].
_LEAP_RAD = 0.1
#: What another minimum must save in the markers' cost: odds of 10 : 1. Where two triples of a ball joint's angles
#: are one posture, the prior alone differs, and angles that leap between them would be no motion.
_SAVES = 2.0 * math.log(10.0)
#: The search from another posture ends where a step saves less: a hundredth of what decides. The best is finished.
_HARDLY_SAVES = 0.01 * _SAVES
#: A search ends where a step saves less than this fraction of the cost.
_SETTLED_SHARE = 1e-9
#: A frame begins anew where its markers are farther off than this, in standard deviations, rms over them.
_FAR = 5.0


def follow(
    chain: MarkerChain,
    frames: Frames,
    std_m: Floats,
    prior: AnglePrior,
    seed: int,
    near: Floats | None = None,
    begin: Floats | None = None,
) -> Floats:
    """Return the angles that bring the chain nearest to the markers, (n_frame, n_joint).

    Parameters
    ----------
    chain : MarkerChain
    frames : Frames
    std_m : (m,)
        Of each marker.
    prior : AnglePrior
    seed : int
        Of the postures that a frame begins anew from.
    near : (n_frame, n_joint), optional
        Angles to begin at, in place of those of the frame before.
    begin : (n_frame, n_joint), optional
        Where the postures that a frame begins anew from lie about; the prior's mean.
    """
    n = len(prior.mean)
    rng = np.random.default_rng([seed, 7])
    spread = np.minimum(1.0 / np.sqrt(prior.information), np.pi / 2.0)
    starts = np.vstack([np.zeros(n), rng.normal(size=(_STARTS - 1, n)) * spread])
    about = np.tile(prior.mean, (len(frames.y), 1)) if begin is None else np.ascontiguousarray(begin)
    q = about.copy() if near is None else near.copy()
    _follow(chain, frames, std_m**2, prior, about, starts, near is not None, slopes_room(n, 0), q)
    return q


@compiled
def _follow(
    chain: MarkerChain,
    frames: Frames,
    variance: Floats,
    prior: AnglePrior,
    about: Floats,
    starts: Floats,
    near: bool,
    room: Slopes,
    q: Floats,
) -> None:
    n, n_frame, last = q.shape[1], q.shape[0], 0
    trial_q, best_q, cost = np.empty(n), np.empty(n), np.empty(n_frame)
    for k in range(n_frame):
        begins = k == 0 or frames.trial[k] != frames.trial[k - 1]
        if not near and not begins:
            q[k] = q[k - 1]
        cost[k] = solve_frame(chain, frames, k, variance, prior, 60, room, q[k])
        n_seen = 0
        for m in range(chain.link.size):
            n_seen += not np.isnan(frames.y[k, m, 0])
        anew = begins or cost[k] > n_seen * t_cost(_FAR**2, 1.0)
        if n_seen and (anew or k - last >= _ANEW_EVERY):
            last = k
            best_q[:] = q[k]
            better = False
            for s in range(starts.shape[0]):
                trial_q[:] = about[k] + starts[s]
                found = solve_frame(chain, frames, k, variance, prior, 60, room, trial_q, _HARDLY_SAVES)
                saved = cost[k] - found
                if saved > 1e-6 * abs(cost[k]) and (anew or saved - _freed(prior, best_q, trial_q) > _SAVES):
                    cost[k] = found
                    best_q[:] = trial_q
                    better = True
            if better:
                q[k] = best_q
                cost[k] = solve_frame(chain, frames, k, variance, prior, 60, room, q[k])
    for way in (-1, 1):
        for i in range(1, n_frame):
            k = n_frame - 1 - i if way < 0 else i
            if frames.trial[k] == frames.trial[k - way] and np.abs(q[k - way] - q[k]).max() > _LEAP_RAD:
                trial_q[:] = q[k - way]
                found = solve_frame(chain, frames, k, variance, prior, 60, room, trial_q)
                saved = cost[k] - found
                if saved > 0.0 and saved - _freed(prior, q[k], trial_q) > _SAVES:
                    cost[k] = found
                    q[k] = trial_q


@compiled
def _freed(prior: AnglePrior, q: Floats, other: Floats) -> float:
    """Return how much less other angles cost by the prior."""
    total = 0.0
    for i in range(q.size):
        total += prior.information[i] * ((q[i] - prior.mean[i]) ** 2 - (other[i] - prior.mean[i]) ** 2)
    return total


@compiled
def solve_frame(
    chain: MarkerChain,
    frames: Frames,
    k: int,
    variance: Floats,
    prior: AnglePrior,
    most: int,
    room: Slopes,
    q: Floats,
    saves: float = 0.0,
) -> float:
    """Turn ``q`` (n,) into the angles of frame ``k`` by Levenberg-Marquardt; return the cost there.

    It ends where a step saves less than ``saves``, or hardly anything.
    """
    n = q.size
    A, a, there, slope, trial = np.empty((n, n)), np.empty(n), np.empty((n, n)), np.empty(n), np.empty(n)
    damping = 1e-3
    cost = frame_equations(chain, frames, k, variance, prior, q, room, A, a)
    for _ in range(most):
        damped = A.copy()
        for i in range(n):
            damped[i, i] *= 1.0 + damping
        step = np.linalg.solve(damped, a)
        size = np.abs(step).max()
        if size > 1.0:
            step /= size
        trial[:] = q + step
        found = frame_equations(chain, frames, k, variance, prior, trial, room, there, slope)
        if found <= cost:
            done = cost - found < max(saves, _SETTLED_SHARE * (1.0 + cost)) or size < 1e-9
            q[:] = trial
            A[:], a[:], cost = there, slope, found
            damping = max(damping * 0.2, 1e-9)
            if done:
                break
        else:
            damping *= 5.0
            if damping > 1e6:
                break
    return cost


def predicted(chain: MarkerChain, frames: Frames, q: Floats) -> Floats:
    """Return where the chain has its markers, (n_frame, m, 3) [m]."""
    y = np.empty_like(frames.y)
    _predicted(chain, frames, np.ascontiguousarray(q), slopes_room(q.shape[1], 0), y)
    return y


@compiled
def _predicted(chain: MarkerChain, frames: Frames, q: Floats, room: Slopes, y: Floats) -> None:
    for k in range(q.shape[0]):
        link_frames(chain, frames.R[k], frames.p[k], q[k], room)
        for m in range(chain.link.size):
            marker_at(chain, room, m, y[k, m])


def link_poses(chain: MarkerChain, frames: Frames, q: Floats) -> tuple[Floats, Floats]:
    """Return the joint-axis frames in the world, R (n_frame, n_joint, 3, 3) and o (n_frame, n_joint, 3) [m]."""
    R, o = np.empty((*q.shape, 3, 3)), np.empty((*q.shape, 3))
    _link_poses(chain, frames, np.ascontiguousarray(q), slopes_room(q.shape[1], 0), R, o)
    return R, o


@compiled
def _link_poses(chain: MarkerChain, frames: Frames, q: Floats, room: Slopes, R: Floats, o: Floats) -> None:
    for k in range(q.shape[0]):
        link_frames(chain, frames.R[k], frames.p[k], q[k], room)
        R[k] = room.R
        o[k] = room.o
