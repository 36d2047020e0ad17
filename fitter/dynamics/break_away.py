"""Static friction from break-away: what friction held while a joint stood, and at what torque it let go.

Eq. (8) holds for moving joints, so static friction F is in no torque fit. But while a joint stands still, friction
alone takes up the load: the torque that drives it less what gravity and the other joints' motion put on it. F is
at least the largest load that was held, and at most the smallest at which the joint let go.

Standing means that no motion is seen, so what is proved is less. Over any time T within a stand the momentum
changes by no more than twice the smallest that is seen, P; friction was at least the mean load less 2 P / T. So
neither a joint that turns round slowly nor one that let go and is not yet seen to move is taken to be held.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.base_parameters import BaseParameters
from arm.control import control_torque
from arm.model import Arm, Estimate, Floats, Friction
from arm.newton_euler import inverse_dynamics, mass_matrix
from arm.regressor import regressor
from fitter.data.trials import Trial
from fitter.dynamics.structure import structural_parameters
from fitter.search.fitted_parameter import FittedParameter

#: A joint stands if it is slower than so many standard deviations of its velocity's noise, and than this share of
#: its top speed, for so long.
_NOISES, _SHARE, _LEAST_STAND_S = 5.0, 1e-4, 0.05
#: Where a joint let go the load is averaged over so many samples that it is known to this share of the largest.
_KNOWN = 0.02
#: What is proved stands out by so many standard errors: F from zero and from Coulomb friction, a load from noise.
_TOLD = 3.0
#: What exceeds Coulomb friction by less than this share is no static friction of its own.
_ALIKE = 0.01
#: A normal deviation's size in units of the median of its absolute value; and of second differences.
_MEDIAN, _SECOND = 1.4826, np.sqrt(6.0)


@dataclass(frozen=True)
class StaticFriction:
    """The static friction of one joint.

    Attributes
    ----------
    parameter : FittedParameter
        F [N m or N]; the arm's own where it is not identifiable.
    held, let_go : float
        Largest load held, 0 if none; smallest load at which it let go, infinite if it never did.
    why : str
        How F was bracketed, or what is missing.
    """

    parameter: FittedParameter
    held: float
    let_go: float
    why: str


@dataclass(frozen=True)
class _Stand:
    """What one stand of one joint says: a load it held, one at which it let go (or infinity), and their errors.

    ``error`` comes from noise, ``model`` from what the arm's masses are not known to.
    """

    held: float
    let_go: float
    error: float
    model: float


def static_friction(arm: Arm, trials: Sequence[Trial]) -> list[StaticFriction]:
    """Return the static friction of every joint, where its break-away shows it.

    Parameters
    ----------
    arm : Arm
        A calibrated one: its masses say what gravity and the other joints put on a standing one, its law or the
        trials' torque what drives it, its Coulomb friction what F must exceed to be told from it.
    trials : sequence of Trial

    Returns
    -------
    list of StaticFriction
        One a joint.
    """
    base = structural_parameters(arm)
    return [_of_joint(arm, base, trials, i) for i in range(arm.n_joint)]


def _of_joint(arm: Arm, base: BaseParameters, trials: Sequence[Trial], i: int) -> StaticFriction:
    joint, name = arm.joints[i], f"F{i + 1}"
    unit = "N m" if joint.type == "revolute" else "N"
    untold = FittedParameter(joint.friction.static_N_m, np.nan, unit, False)
    driven = [trial for trial in trials if _has_torque(arm, trial)]
    if not driven:
        missing = "torque tau" if arm.control.law == "measured" else "target ref"
        return StaticFriction(untold, 0.0, np.inf, f"{name} needs the {missing}{i + 1} of the trials")
    stands = [stand for trial in driven for stand in _stands(arm, base, trial, i)]
    if not stands:
        why = f"joint {i + 1} never stood still for {_LEAST_STAND_S:g} s; {name} needs it to stick, then to let go"
        return StaticFriction(untold, 0.0, np.inf, why)
    error = float(np.hypot(np.median([stand.error for stand in stands]), max(stand.model for stand in stands)))
    held, let_go = max(stand.held for stand in stands), min(stand.let_go for stand in stands)
    if not np.isfinite(let_go):
        why = f"joint {i + 1} held up to {held:.3g} {unit} and never let go: {name} is at least that"
        return StaticFriction(untold, held, let_go, why)
    value, std = float((held + let_go) / 2.0), float(np.hypot((let_go - held) / np.sqrt(12.0), error))
    coulomb = max(joint.friction.coulomb_N_m, 0.0)
    above = coulomb * (1.0 + _ALIKE) + _TOLD * np.hypot(error, _coulomb_std(arm, i))
    said = f"joint {i + 1} held {held:.3g} {unit} and let go at {let_go:.3g} {unit}"
    if value < _TOLD * std:
        why = f"{said}: too wide a bracket for {name}; a target or torque that rises slowly would narrow it"
    elif held <= above:
        why = f"{said}, and Coulomb friction is {coulomb:.3g} {unit}: no static friction above it is proved"
    elif held - let_go > _TOLD * error:
        why = f"{said}: no friction does both, so {name} is not told; a joint that creeps looks as if it stood"
    else:
        return StaticFriction(
            FittedParameter(value, std, unit, True), held, let_go, f"{said}: {name} lies between"
        )
    return StaticFriction(untold, held, let_go, why)


def _has_torque(arm: Arm, trial: Trial) -> bool:
    return (trial.tau if arm.control.law == "measured" else trial.ref) is not None


def _coulomb_std(arm: Arm, i: int) -> float:
    std = arm.base_parameters.get(f"fc{i + 1}", Estimate(0.0)).std
    return float(std) if np.isfinite(std) else 0.0


def _stands(arm: Arm, base: BaseParameters, trial: Trial, i: int) -> list[_Stand]:
    """Return what every stand of a joint in a trial says."""
    dq = trial.dq[:, i]
    least = max(8, round(_LEAST_STAND_S / trial.dt_s))
    slowest, noise = _SHARE * float(np.max(np.abs(dq), initial=0.0)), _NOISES * _deviation(dq)
    window = int(np.clip((noise / slowest) ** 2, 1, least // 2)) if slowest > 0.0 else 1
    seen = slowest + noise / np.sqrt(window)
    mean = _means(dq, window)  # over the past: what is seen to move has let go by then
    edges = np.flatnonzero(np.diff(np.concatenate([[False], np.abs(mean) <= seen, [False]]).astype(int)))
    return [
        _stand(arm, base, trial, i, int(start), int(stop), seen, window)
        for start, stop in zip(edges[::2], edges[1::2], strict=True)
        if stop - start >= least
    ]


def _stand(
    arm: Arm, base: BaseParameters, trial: Trial, i: int, start: int, stop: int, seen: float, window: int
) -> _Stand:
    """Bracket friction by a stand from ``start`` to ``stop``, where motion is seen if the trial goes on."""
    n, rows = stop - start, slice(start, min(stop + 1, len(trial.q)))
    q, dq, ddq = trial.q[rows], trial.dq[rows], trial.ddq[rows].copy()
    drift = float(np.mean(dq[n // 4 : n - n // 4, i]))
    ddq[:, i] = 0.0
    load = _torque(arm, trial, rows, q, dq, ddq)[:, i] - inverse_dynamics(_frictionless(arm), q, dq, ddq)[:, i]
    noise, size = _deviation(load[:n]), float(np.max(np.abs(load)))
    inertia = float(mass_matrix(arm, q[-1:])[0, i, i])
    at = slice(n // 2, n // 2 + 1)
    model = _load_error(arm, base, q[at], dq[at], ddq[at], i)
    held, error = _held(load[: n - 1], window, noise, 2.0 * inertia * seen / trial.dt_s)
    creeps = abs(drift) > _TOLD * _deviation(trial.dq[:, i]) / np.sqrt(max(n // 2, 1)) + seen / _NOISES
    if stop >= len(trial.q) or creeps:
        return _Stand(held, np.inf, error, model)
    way = np.sign(trial.dq[stop, i]) or np.sign(load[-1])
    width = int(np.clip(np.ceil((noise / (_KNOWN * size)) ** 2), 1, n // 4)) if size > 0.0 else 1
    pull = way * _means(load, width)
    # Of a load that rises evenly a mean lags half a window; where one jumps, the load itself less noise is taken.
    lag = abs(pull[-1] - pull[max(len(pull) - 1 - width, 0)]) / 2.0 if width > 1 else 0.0
    spread = noise * np.sqrt(2.0 * np.log(n))
    let_go = max(float(np.max(pull) + lag), float(np.max(way * load) - spread))
    return _Stand(held, let_go if let_go > 0.0 else np.inf, error, model)


def _held(load: Floats, window: int, noise: float, momentum: float) -> tuple[float, float]:
    """Return the largest friction that a stand proves, and its error.

    Parameters
    ----------
    load : (n_sample,)
        From the stand's first sample to the last but one: the last one's load had no time to act.
    window : int
        Velocities were judged by means over so many samples; the same means of the load belong to them.
    noise : float
        Standard deviation of the load.
    momentum : float
        What may go unseen, over the step of the samples.
    """
    smooth = _means(load, window)[window - 1 :]
    best, error, length = 0.0, noise, 1
    while length <= len(smooth):
        mean = np.abs(_means(smooth, length)[length - 1 :])
        doubt = noise / np.sqrt(max(length, window))
        proved = float(np.max(mean)) - momentum / length - _TOLD * doubt
        if proved > best:
            best, error = proved, doubt
        length = max(length + 1, round(1.2 * length))
    return best, error


def _torque(arm: Arm, trial: Trial, rows: slice, q: Floats, dq: Floats, ddq: Floats) -> Floats:
    """Return the driving torque, of the law without the standing joint's acceleration."""
    if arm.control.law == "measured":
        assert trial.tau is not None
        return trial.tau[rows]
    assert trial.ref is not None
    if trial.drives is not None:
        return trial.drives.rows(rows).torque(arm.control, q, dq, ddq, trial.ref[rows])
    return control_torque(arm.control, q, dq, ddq, trial.ref[rows])


def _load_error(arm: Arm, base: BaseParameters, q: Floats, dq: Floats, ddq: Floats, i: int) -> float:
    """Return how well a load is known, from the standard errors of the arm's base parameters, one by one."""
    std = np.array([arm.base_parameters.get(name, Estimate(0.0)).std for name in base.names])
    inertial = np.asarray(base.independent) < 10 * arm.n_joint
    row = regressor(arm, q, dq, ddq)[0, i, base.independent]
    return float(np.linalg.norm((row * np.nan_to_num(std))[inertial]))


def _frictionless(arm: Arm) -> Arm:
    return replace(arm, joints=tuple(replace(joint, friction=Friction()) for joint in arm.joints))


def _means(values: Floats, window: int) -> Floats:
    """Return means over the last samples, fewer at the beginning."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    last = np.arange(1, len(values) + 1)
    first = np.maximum(last - window, 0)
    return np.asarray((total[last] - total[first]) / (last - first), dtype=np.float64)


def _deviation(values: Floats) -> float:
    """Return the standard deviation of white noise on something smooth, from second differences."""
    bends = np.diff(values, 2)
    return float(_MEDIAN * np.median(np.abs(bends)) / _SECOND) if len(bends) else 0.0
