r"""Trials held back: what models get wrong on them, and whether they ask something new of the arm.

What a motion asks is the second moments of its regressor, a sample. Of these matrices A, of it, and B, of
others, the generalized eigenvalues are how much more information it has of a combination of parameters than they
have, whatever the units and the base parameters (Förstner and Moonen 1999). What is new in it counts, and not
what it lacks:

.. math:: d(A, B) = \sqrt{\sum_i \max(\log \lambda_i(A, B), 0)^2 / n}

It is compared with the novelty of each of the learning motions relative to the other ones.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg
from scipy.ndimage import binary_erosion, gaussian_filter1d

from arm.control import gains
from arm.effects.effect_table import changed, effect_table
from arm.effects.joint_numbers import ROTOR
from arm.model import Arm, Floats
from arm.newton_euler import mass_matrix
from arm.simulation import simulate
from fitter.diagnosis.evidence import blocks_of
from fitter.diagnosis.held_out_error import Errors, Judged
from fitter.diagnosis.least_squares import ROUNDED
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.whitening import RISE_S
from fitter.dynamics.evaluation import HORIZON_S
from fitter.parallel.forked import side_by_side
from limbcal.note import Note

#: A fitted model, and the arm that it is, to be simulated.
Fitted = tuple[Candidate, Arm]


def judged_sets(
    regression: Regression,
    models: tuple[Fitted, Fitted],
    motions: Sequence[Motion],
    sets: Sequence[str],
    horizon_s: float,
) -> Judged:
    """Return what two models get wrong on trials that had no say in anything.

    Parameters
    ----------
    regression : Regression
    models : (before, after)
        Each with its arm.
    motions : sequence of Motion
        Not thinned, under numbers that no other trial of the run has.
    sets : sequence of str
        The set that each of them is of.
    horizon_s : float
        With measured or no torque, how long a simulation runs before it starts anew from the data.
    """
    (base, base_arm), (final, arm) = models
    before = judged(regression, base, base_arm, motions, horizon_s)
    after = before if final is base else judged(regression, final, arm, motions, horizon_s)
    return Judged(sets, [motion.trial.name for motion in motions], before, after)


def likeness(regression: Regression) -> Note | None:
    """Return a note if no more is new in the evaluating motions than in the learning ones, by their medians."""
    rows = {motion.number: regression.rows(Model(), motion).design for motion in regression.motions}
    learnt, held_back = (
        [rows[motion.number] for motion in regression.motions if motion.learn is learn] for learn in (True, False)
    )
    if not learnt or not held_back:
        return None
    parts = learnt if len(learnt) > 1 else np.array_split(learnt[0], 2)
    own = np.median([novelty([one], [*parts[:k], *parts[k + 1 :]]) for k, one in enumerate(parts)])
    others = np.median([novelty([one], learnt) for one in held_back])
    if others > own:
        return None
    return Note(
        "alike",
        "the evaluating motions are like the learning ones: the second moments of their regressors are larger by "
        f"{np.exp(others):.3g} times, those of a learning motion by {np.exp(own):.3g} times than the others'; how "
        "motions of another kind are predicted, this data does not show",
    )


def novelty(some: Sequence[Floats], others: Sequence[Floats]) -> float:
    """Return the novelty of some rows, (n_row, n_column) each, relative to others."""
    A, B = (np.sum([one.T @ one for one in rows], axis=0) / sum(map(len, rows)) for rows in (some, others))
    size = np.sqrt(np.diag(A) + np.diag(B))
    excited = size > 0.0
    A, B = (moments[np.ix_(excited, excited)] / np.outer(size[excited], size[excited]) for moments in (A, B))
    values, axes = np.linalg.eigh(A + B)
    kept = values > np.sqrt(ROUNDED) * values[-1]
    root = axes[:, kept] / np.sqrt(values[kept])
    least = np.sqrt(ROUNDED) * np.eye(root.shape[1])
    ratios = scipy.linalg.eigh(root.T @ A @ root + least, root.T @ B @ root + least, eigvals_only=True)
    return float(np.sqrt(np.mean(np.log(np.maximum(ratios, 1.0)) ** 2)))


def torque_residual(regression: Regression, fitted: Candidate, motion: Motion) -> Floats:
    """Return the torque that a model leaves of what was measured, NaN where that is unknown, (n_sample, n_joint).

    Where nobody recorded the target it is the one that this model explains the motion with.
    """
    residual = _by_given_target(regression, fitted, motion)
    return residual - _mean(residual) if motion.trial.target_std is not None else residual


def aimed(regression: Regression, fitted: Candidate, motion: Motion) -> Motion:
    """Return a motion with the target that a model explains it with, where nobody recorded one."""
    trial = motion.trial
    if trial.target_std is None or trial.ref is None:
        return motion
    missing, kp = (
        _mean(_by_given_target(regression, fitted, motion)),
        gains(regression.arm.control, trial.q.shape[1])[0],
    )
    off = np.where(kp != 0.0, missing / np.where(kp != 0.0, kp, 1.0), 0.0)
    return replace(motion, trial=replace(trial, ref=trial.ref - off * (trial.ref == trial.ref[-1])))


def _by_given_target(regression: Regression, fitted: Candidate, motion: Motion) -> Floats:
    return np.where(motion.unknown, np.nan, regression.equations.residual_torque(fitted.model, fitted.x, motion))


def _mean(values: Floats) -> Floats:
    """Return the mean of what is known, joint by joint; zero where nothing is."""
    is_known = np.isfinite(values)
    total = np.sum(np.where(is_known, values, 0.0), axis=0)
    return np.asarray(total / np.maximum(np.count_nonzero(is_known, axis=0), 1), dtype=np.float64)


def unfiltered(residual: Floats, motion: Motion) -> Floats | None:
    """Return the residual of the measured torque, its noise included; None where none was measured.

    Parameters
    ----------
    left : (n_sample, n_joint)
        The same behind the filter of the trial's columns, see `torque_residual`.
    motion : Motion
        Not thinned.
    """
    trial = motion.trial
    return None if trial.tau is None or trial.tau_measured is None else residual + trial.tau_measured - trial.tau


def judged(
    regression: Regression, fitted: Candidate, arm: Arm, motions: Sequence[Motion], horizon_s: float = HORIZON_S
) -> Errors:
    """Return what a model gets wrong.

    Parameters
    ----------
    regression : Regression
    fitted : Candidate
        The model, by its equations.
    arm : Arm
        The same, to be simulated.
    motions : sequence of Motion
        Not thinned.
    horizon_s : float
        With measured or no torque, how long a simulation runs before it starts anew from the data.
    """
    turns = np.array([joint.type == "revolute" for joint in arm.joints])
    torque, trial, raw, off = list[Floats](), list[int](), list[Floats](), list[Floats]()
    angles = side_by_side(lambda motion: simulated(arm, aimed(regression, fitted, motion), horizon_s), motions)
    for k, (motion, followed) in enumerate(zip(motions, angles, strict=True)):
        residual = torque_residual(regression, fitted, motion)
        seen = smooth(residual, motion.dt_s, regression.weighting.seen_hz)
        starts = np.flatnonzero(np.diff(blocks_of(len(seen), motion.dt_s), prepend=-1))
        both = np.stack([np.nan_to_num(seen) ** 2, np.isfinite(seen)])
        torque.append(np.add.reduceat(both, starts, axis=1))
        trial += [k] * len(starts)
        whole = unfiltered(np.where(np.isfinite(seen), residual, np.nan), motion)
        if whole is not None:
            raw.append(np.nansum(whole**2, axis=0))
        apart = np.abs(followed - motion.trial.q)
        # So far off less than a millionth of a turn is left in an angle: it has run away.
        off.append(np.where(apart < 1.0 / np.sqrt(ROUNDED), apart, np.inf))
    driven = any(np.any(motion.u) for motion in motions)
    squares, counts = np.concatenate(torque, axis=1)
    return Errors(
        squares,
        counts,
        np.array(trial, dtype=np.intp),
        np.array(raw) if driven and len(raw) == len(motions) else None,
        np.array([np.sum(one**2, axis=0) for one in off]),
        np.array([np.sum(one, axis=0) for one in off]),
        np.array([np.max(one, axis=0, initial=0.0) for one in off]),
        np.array([np.full(len(turns), len(one), dtype=np.float64) for one in off]),
        turns,
        angles,
    )


def smooth(residual: Floats, dt_s: float, corner_hz: float) -> Floats:
    """Return what of a torque is slower than a corner, as a mean of what is known: gaps are not bridged.

    Next to a gap the columns' own filter still has part of what is in it.
    """
    margin = np.ones((2 * max(1, round(RISE_S / dt_s)) + 1, 1), dtype=np.bool_)
    known = binary_erosion(np.isfinite(residual), margin, border_value=True)
    width = np.sqrt(np.log(2.0)) / (2.0 * np.pi * corner_hz * dt_s)  # its power is halved at the corner
    total = gaussian_filter1d(np.where(known, residual, 0.0), width, axis=0, mode="constant")
    weight = gaussian_filter1d(known.astype(np.float64), width, axis=0, mode="constant")
    return np.where(known, total / np.maximum(weight, ROUNDED), np.nan)


def simulated(arm: Arm, motion: Motion, horizon_s: float, rest_s: float = 0.04) -> Floats:
    """Return the angles of an arm with its effects, driven as in a trial, (n_sample, n_joint).

    Under a control law it runs through the whole trial; with measured torque it starts anew every ``horizon_s``.
    A trial that begins at rest begins at the mean of its first ``rest_s``.
    Infinite where masses that none can have would run from a push towards where it comes from.
    """
    trial = motion.trial
    if not _has_mass(arm, motion):
        return np.where(np.arange(len(trial.q))[:, None] == 0, trial.q, np.inf)
    t0 = float(motion.t[0])
    if arm.control.law != "measured" and trial.ref is not None:
        rest = max(1, round(rest_s / trial.dt_s))
        still = motion.stuck[0]
        q0 = np.where(still, trial.q[:rest].mean(axis=0), trial.q[0])
        dq0 = np.where(still, 0.0, trial.dq[0])
        return simulate(arm, trial.ref, trial.dt_s, q0, dq0, t0_s=t0, trial=motion.number, drives=trial.drives).q
    angles = trial.q.copy()
    torque = motion.u if len(motion.u) == len(trial.q) else np.asarray(trial.tau)
    stride = max(1, round(horizon_s / trial.dt_s))
    for start in range(0, len(trial.q) - 1, stride):
        part = slice(start, min(start + stride + 1, len(trial.q)))
        angles[start + 1 : part.stop] = simulate(
            arm,
            trial.q[part],
            trial.dt_s,
            trial.q[start],
            np.where(motion.stuck[min(start, len(motion.stuck) - 1)], 0.0, trial.dq[start]),
            torque=torque[part],
            t0_s=t0 + start * trial.dt_s,
            trial=motion.number,
        ).q[1:]
    return angles


def _has_mass(arm: Arm, motion: Motion) -> bool:
    """Say whether the mass matrix of the joints that move, rotors included, is positive definite all the way."""
    stuck, own = motion.stuck, np.arange(arm.n_joint)
    inner = changed(arm)
    M = mass_matrix(inner, motion.q)
    M[stuck[:, :, None] | stuck[:, None, :]] = 0.0
    M[:, own, own] += np.where(stuck, 1.0, effect_table(inner, motion.number).numbers[ROTOR])
    return bool(np.linalg.eigvalsh(M).min(initial=np.inf) > 0.0)
