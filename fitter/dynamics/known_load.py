r"""A load of known mass at the tip, in some trials: its torque is no part of the arm, and it gauges the torque.

The torque :math:`Y_L m` of a load follows from its mass and the motion. Without it a loaded trial is one of the
bare arm. And a torque that was measured by a factor :math:`c_j` too large,

.. math:: \tau_j = c_j (Y_j \pi + Y_{L,j} m),

makes masses too large by it, which no motion of the bare arm tells; loaded and unloaded trials together do
(M. Gautier and S. Briot, *Global identification of drive gains and dynamic parameters of robots*, 2014).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.base_parameters import BaseParameters
from arm.effects.payload import with_load
from arm.model import Arm, Floats
from arm.newton_euler import inverse_dynamics
from arm.regressor import regressor
from fitter.data.known_torque import without_torque
from fitter.data.standstill import REST_SPEED
from fitter.data.trial import Trial
from fitter.regression_sums.trial_sums import moving_all_along
from fitter.search.fitted_parameter import FittedParameter
from fitter.search.standard_errors import sandwich_covariance
from limbcal.errors import DataError
from limbcal.note import Note

#: Samples of a trial that are looked at, at the most: neighbours say the same.
_SAMPLES = 2000
#: Length of a block, within which errors may resemble each other [s]; and how many there are in all, at least:
#: of fewer the scatter says little.
_BLOCK_S, _BLOCKS = 0.5, 60
#: Gauss-Newton steps at the most; they end when no factor changes by more than this.
_STEPS, _CLOSE_ENOUGH = 30, 1e-6
#: Number of standard errors beyond which a factor differs from one: by chance one in 16 000.
_SIGMAS = 4.0
#: Singular values below this ratio to the largest are zero.
_RANK = 1e-9
#: A number is determined if no more than this part of it, squared, lies in the null space.
_NULL = 1e-6


@dataclass(frozen=True)
class KnownLoad:
    """A mass at the tip.

    Attributes
    ----------
    mass_kg : float
    trials : frozenset of int
        In which it is there, from 1, those of learning first.
    """

    mass_kg: float
    trials: frozenset[int]


def without_load(arm: Arm, trials: Sequence[Trial], load: KnownLoad) -> list[Trial]:
    """Return trials as of the bare arm.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
        All of the run, with their measured torque.
    load : KnownLoad

    Raises
    ------
    DataError
        If there is no such trial, or one has no measured torque.
    """
    if load.trials and max(load.trials) > len(trials):
        raise DataError(f"--payload names trial {max(load.trials)} of {len(trials)}; expected one that there is")

    def known(q: Floats, dq: Floats, ddq: Floats, _tau: Floats, _t: Floats) -> Floats:
        return load_torque(arm, (q, dq, ddq), load.mass_kg)

    return [without_torque(trial, known) if k in load.trials else trial for k, trial in enumerate(trials, 1)]


def _torque(trial: Trial) -> Floats:
    if trial.tau is None:
        raise DataError(f"{trial.name}: no torque was measured, expected columns tau1… with --payload")
    return trial.tau


def load_torque(arm: Arm, motion: tuple[Floats, Floats, Floats], mass_kg: float) -> Floats:
    """Return the torque of a mass at the tip along a motion, (n_sample, n_joint): it is linear in the mass."""
    plain = replace(arm, effects=())
    return inverse_dynamics(with_load(plain, mass_kg), *motion) - inverse_dynamics(plain, *motion)


def torque_factors(
    arm: Arm, base: BaseParameters, trials: Sequence[Trial], load: KnownLoad
) -> list[FittedParameter]:
    """Return by which factor each joint's torque was measured too large; nothing unless some trials are bare.

    Parameters
    ----------
    arm : Arm
    base : BaseParameters
    trials : sequence of Trial
        Those learnt from, with the torque as it was measured.
    load : KnownLoad

    Raises
    ------
    DataError
        If one has no measured torque.
    """
    loaded = [k in load.trials for k in range(1, len(trials) + 1)]
    if not any(loaded) or all(loaded):
        return []
    least = -(-_BLOCKS // len(trials))
    masses = [load.mass_kg if on else 0.0 for on in loaded]
    parts = [_rows(arm, base, trial, mass, least) for trial, mass in zip(trials, masses, strict=True)]
    Y, known, tau, used = (np.concatenate(some) for some in list(zip(*parts, strict=True))[:4])
    n_base, n = Y.shape[2], arm.n_joint
    x = np.concatenate([np.zeros(n_base), np.ones(n)])
    scale = np.sqrt(np.sum(tau**2 * used, axis=0) / np.maximum(np.count_nonzero(used, axis=0), 1))
    weight = used / np.where(scale > 0.0, scale, 1.0)

    def equations(x: Floats) -> tuple[Floats, Floats]:
        pi, c = x[:n_base], x[n_base:]
        explained = Y @ pi + known
        slopes = np.concatenate([c[:, None] * Y, explained[:, :, None] * np.eye(n)], axis=2)
        return slopes * weight[..., None], (tau - c * explained) * weight

    pinv = np.linalg.pinv((Y * weight[..., None]).reshape(-1, n_base), rcond=_RANK)
    x[:n_base] = pinv @ ((tau - known) * weight).ravel()
    for _ in range(_STEPS):
        A, r = equations(x)
        step = np.linalg.lstsq(A.reshape(-1, A.shape[2]), r.ravel(), rcond=_RANK)[0]
        x = x + step
        if np.abs(step[n_base:]).max() < _CLOSE_ENOUGH:
            break
    A, r = equations(x)
    std = _standard_errors(A, r, [part[4] for part in parts])[n_base:]
    return [
        FittedParameter(float(c), float(error), "1", bool(np.isfinite(error)))
        for c, error in zip(x[n_base:], std, strict=True)
    ]


def by_factors(trials: Sequence[Trial], factors: Sequence[FittedParameter]) -> list[Trial]:
    """Return trials whose torque is in the load's unit: divided by the factors that are other than one."""
    if not any(_is_other(one) for one in factors):
        return list(trials)
    c = np.array([one.value if _is_other(one) else 1.0 for one in factors])
    return [
        replace(
            trial,
            tau=None if trial.tau is None else trial.tau / c,
            tau_measured=None if trial.tau_measured is None else trial.tau_measured / c,
            whole={name: values / c if name == "tau" else values for name, values in trial.whole.items()},
        )
        for trial in trials
    ]


def _is_other(factor: FittedParameter) -> bool:
    return factor.identifiable and abs(factor.value - 1.0) > _SIGMAS * factor.std


def factor_notes(factors: Sequence[FittedParameter]) -> list[Note]:
    """Say which joints' torque was measured by another unit than the load's."""
    return [
        Note(
            "torque_factor",
            f"by the known load the torque of joint {j} was measured too large by a factor of {one.value:.3g} "
            f"± {one.half_width:.2g}; it was divided by that, or the masses that it moves would be off by as much",
        )
        for j, one in enumerate(factors, 1)
        if _is_other(one)
    ]


def _rows(
    arm: Arm, base: BaseParameters, trial: Trial, mass_kg: float, least: int
) -> tuple[Floats, Floats, Floats, NDArray[np.bool_], list[int]]:
    """Return regressor, known torque, measured torque, which count, and the number of rows of each block.

    ``least`` is the smallest number of blocks.
    """
    at = np.arange(0, len(trial.q), max(1, len(trial.q) // _SAMPLES))
    Y = regressor(arm, trial.q, trial.dq, trial.ddq)[..., base.independent]
    known = load_torque(arm, (trial.q, trial.dq, trial.ddq), mass_kg) if mass_kg else np.zeros_like(trial.q)
    used = moving_all_along(trial, slice(0, len(trial.q)), REST_SPEED)
    lowpassed = [trial.lowpass(one)[at] for one in (Y, known, _torque(trial))]
    blocks = np.array_split(at, max(least, round(len(trial.q) * trial.dt_s / _BLOCK_S)))
    return lowpassed[0], lowpassed[1], lowpassed[2], used[at], [len(block) for block in blocks]


def _standard_errors(A: Floats, r: Floats, blocks: Sequence[Sequence[int]]) -> Floats:
    """Return standard errors that allow for errors that resemble their neighbours'; NaN for what is not known."""
    n = A.shape[2]
    _, s, Vt = np.linalg.svd(A.reshape(-1, n), full_matrices=False)
    kept = s > _RANK * s[0]
    ends = np.cumsum([length for trial in blocks for length in trial])[:-1]
    group = np.repeat(np.arange(len(blocks)), [len(trial) for trial in blocks])
    V = Vt[kept].T
    scores, grams = [], []
    for part, residual in zip(np.split(A, ends), np.split(r, ends), strict=True):
        rows = part.reshape(-1, n) @ V
        grams.append(rows.T @ rows)
        scores.append(rows.T @ residual.ravel())
    covariance = sandwich_covariance(np.diag(s[kept]), np.array(grams), np.array(scores), group)
    std = np.sqrt(np.diag(V @ covariance @ V.T))
    revealed = np.sum(V**2, axis=1) > 1.0 - _NULL
    return np.where(revealed, std, np.nan)
