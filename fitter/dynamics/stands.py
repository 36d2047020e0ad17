"""What the stands of a joint prove of its friction: how much it held, at which load it let go, how sure both are.

While a joint stands still, friction alone takes up the load: the torque that drives it less what gravity and the
other joints' motion put on it. Standing means that no motion is seen, so what is proved is less: over any time T
within a stand the momentum changes by no more than twice the smallest that is seen, P, and friction was at least
the mean load less 2 P / T. A filter shows motion before it begins and after it has ended, so what was held is
sought away from a stand's ends, by as much as the filter looks around, and a joint has let go that much later at
the latest.

A joint that stands for `fitter.data.standstill` is merely too slow to be of use to a fit; here it must be stuck,
so it is held against the noise of its own velocity, far below that.
"""

from dataclasses import dataclass, replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats, Friction
from arm.newton_euler import inverse_dynamics, mass_matrix
from arm.regressor import regressor
from fitter.data.trial import Trial
from fitter.dynamics.friction_bounds import Bound
from fitter.dynamics.load_noise import LoadNoise, driving_torque, leaks, reach_of, white_noise

#: A joint stands if it is slower than this many standard deviations of its velocity's noise, and than this
#: fraction of its top speed (or what a filter leaks), for so long.
_NOISES, _SHARE, LEAST_STAND_S = 5.0, 1e-4, 0.05
#: A joint creeps, and a load is held, by this many standard errors.
_CREEPS = 3.0
#: What rounding leaves of an angle [1].
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Stand:
    """What one stand proves: what friction is at least; what it is at most, if the joint let go."""

    held: Bound | None
    let_go: Bound | None


def stands(arm: Arm, base: BaseParameters, trial: Trial, i: int, noise: LoadNoise) -> list[Stand]:
    """Return what every stand of a joint in a trial proves.

    Parameters
    ----------
    arm : Arm
    base : BaseParameters
    trial : Trial
        With the torque, or the target that the arm's law needs.
    i : int
        The joint, from 0.
    noise : LoadNoise
        Of this joint.
    """
    dq = trial.dq[:, i]
    least = max(8, round(LEAST_STAND_S / trial.dt_s))
    top, faint = float(np.max(np.abs(dq), initial=0.0)), _NOISES * white_noise(dq)
    slowest = max(_SHARE, leaks(trial)) * top
    window = int(np.clip((faint / slowest) ** 2, 1, least // 2)) if slowest > 0.0 else 1
    seen = slowest + faint / np.sqrt(window)
    torque = driving_torque(arm, trial, i)[:, i]
    mean = _means(dq, window)  # over the past: what is seen to move has let go by then
    edges = np.flatnonzero(np.diff(np.concatenate([[False], np.abs(mean) <= seen, [False]]).astype(int)))
    return [
        _stand(arm, base, trial, i, torque, int(start), int(stop), seen, window, noise)
        for start, stop in zip(edges[::2], edges[1::2], strict=True)
        if stop - start >= least
    ]


def _stand(
    arm: Arm,
    base: BaseParameters,
    trial: Trial,
    i: int,
    torque: Floats,
    start: int,
    stop: int,
    seen: float,
    window: int,
    noise: LoadNoise,
) -> Stand:
    """Bound friction by a stand from ``start`` to ``stop``, where motion is seen if the trial goes on."""
    n, reach = stop - start, reach_of(trial)
    late = min(stop + 1 + reach, len(trial.q))
    rows = slice(start, late)
    q, dq, ddq = trial.q[rows], trial.dq[rows], trial.ddq[rows].copy()
    ddq[:, i] = 0.0
    load = torque[rows] - inverse_dynamics(_frictionless(arm), q, dq, ddq)[:, i]

    def bound(value: float, length: int, at: int, way: float) -> Bound:
        where = slice(at, at + 1)
        row = regressor(arm, q[where], dq[where], ddq[where])[0, i, base.independent]
        inertial = np.asarray(base.independent) < 10 * arm.n_joint
        return Bound(value, noise.of_means(length), -way * row * inertial)

    inside = slice(reach, max(n - 1 - reach, reach))
    inertia = float(mass_matrix(arm, q[n - 1 : n])[0, i, i])
    held = _held(load[inside], window, noise, 2.0 * inertia * seen / trial.dt_s)
    least = None if held is None else bound(held[0], held[1], inside.start + held[2], held[3])
    if stop >= len(trial.q) or _creeps(trial, i, start, stop):
        return Stand(least, None)
    way = float(np.sign(trial.dq[stop, i]) or np.sign(load[n]))
    # It let go at one of these samples: a mean over some would hide how another joint's jerk shook it loose.
    # Between two of them it rose by no more than a step's rise.
    pull = way * load
    pull[1:] += np.maximum(np.diff(pull), 0.0)
    k = int(np.argmax(pull))
    let_go = float(pull[k])
    return Stand(least, bound(let_go, 1, k, way) if let_go > 0.0 else None)


def _creeps(trial: Trial, i: int, start: int, stop: int) -> bool:
    """Say whether a joint moves on within a stand, too slowly to be seen in one sample: it slides, and F is more.

    Angles tell by the means of the second and the third quarter, as they were measured; velocities by their mean.
    """
    quarter = (stop - start) // 4
    angles = trial.whole["q"][trial.trimmed :] if trial.whole else trial.q
    angle, speed = angles[start:stop, i], trial.dq[start + quarter : stop - quarter, i]
    moved = abs(float(np.mean(angle[quarter : 2 * quarter]) - np.mean(angle[-2 * quarter : -quarter])))
    faint = white_noise(angles[:, i]) * np.sqrt(2.0 / quarter) + _ROUNDING * float(np.max(np.abs(angle)))
    if moved > _CREEPS * faint:
        return True
    faint = white_noise(trial.dq[:, i]) / np.sqrt(len(speed))
    return not trial.whole and abs(float(np.mean(speed))) > _CREEPS * faint + _ROUNDING


def _held(load: Floats, window: int, noise: LoadNoise, momentum: float) -> tuple[float, int, int, float] | None:
    """Return the best bound that a stand proves: its value, over how many samples, around which, and which way.

    Parameters
    ----------
    load : (n_sample,)
        Where the joint stood and its load had time to act.
    window : int
        Velocities were judged by means over this many samples; the same means of the load belong to them.
    noise : LoadNoise
    momentum : float
        What may go unseen, over the step of the samples.
    """
    smooth = _means(load, window)[window - 1 :]
    best, found, length = 0.0, None, 1
    while length <= len(smooth):
        means = _means(smooth, length)[length - 1 :]
        k, whole = int(np.argmax(np.abs(means))), max(length, window)
        doubt = noise.of_means(whole)
        # The largest of N normal deviations is at most sqrt(2 log N) on average: of that many means it was picked.
        picked = doubt * np.sqrt(2.0 * np.log(len(load) / whole))
        value = float(abs(means[k])) - momentum / length - picked
        if value - _CREEPS * doubt > best:
            best, found = value - _CREEPS * doubt, (value, whole, k + whole // 2, float(np.sign(means[k])))
        length = max(length + 1, round(1.2 * length))
    return found


def has_torque(arm: Arm, trial: Trial) -> bool:
    """Say whether a trial has what drives the arm: its torque, or the target of the law."""
    return (trial.tau if arm.control.law == "measured" else trial.ref) is not None


def _frictionless(arm: Arm) -> Arm:
    return replace(arm, joints=tuple(replace(joint, friction=Friction()) for joint in arm.joints))


def _means(values: Floats, window: int) -> Floats:
    """Return means over the last samples, fewer at the beginning."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    last = np.arange(1, len(values) + 1)
    first = np.maximum(last - window, 0)
    return np.asarray((total[last] - total[first]) / (last - first), dtype=np.float64)
