r"""Noise in the regressor, which would pass for physics: it makes inertias seem smaller, and all else follows.

Angles that were differentiated twice are noisy, so the design is ``A + N``, and least squares answers
``(A^T A + N^T N)^-1 A^T y`` instead of ``(A^T A)^-1 A^T y``: less by the ratio of noise to signal. Little as that
is, it may be several standard errors where there are many samples. What noise of the size the data have adds to
the normal equations is taken off again (bias-compensated least squares, Stoica and Söderström 1982):

    (A^T A - E[N^T N]) x = A^T y - E[N^T n_y].

The expectation is that of one draw of noise over all trials, sent the way of the data: same filters, same
derivatives, same hypotheses. It has thousands of samples, so it is known to some percent, of a correction that is
a percent itself.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from arm.control import control_torque
from arm.model import Arm, Floats
from fitter.data.derivatives import differentiate, lowpass, settling_samples
from fitter.diagnosis.cutoff import noise_of_angles, white_noise
from fitter.diagnosis.model import Hypothesis, Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.weighting import Rows


@dataclass(frozen=True)
class Noise:
    """What one draw of noise makes of equations, joint by joint, or of all joints' together as of one.

    Attributes
    ----------
    gram : (n_joint or 1, k, k)
        Products of what it makes of the columns.
    rhs : (n_joint or 1, k)
        Their products with what it makes of the right-hand side.
    square : (n_joint or 1,)
        The sum of squares of that.
    """

    gram: Floats
    rhs: Floats
    square: Floats

    def sum_of_squares(self, x: Floats) -> Floats:
        """Return the sum of squares that it leaves at each joint under factors x (k,)."""
        return np.asarray(self.gram @ x @ x - 2.0 * self.rhs @ x + self.square, dtype=np.float64)

    def mixed(self, mixing: Floats) -> "Noise":
        """Return the noise of columns that are mixed of these, by a matrix (k, n_column)."""
        return Noise(mixing.T @ self.gram @ mixing, self.rhs @ mixing, self.square)


def noise_of(columns: Floats, target: Floats) -> Noise:
    """Return the products of what noise makes of columns (n, n_joint, k) and of a target (n, n_joint)."""
    by_joint, at_joint = columns.transpose(1, 2, 0), target.T[..., None]
    return Noise(by_joint @ by_joint.mT, (by_joint @ at_joint)[..., 0], np.sum(target**2, axis=0))


def added(parts: Sequence[Noise]) -> Noise:
    """Return the noise of several motions together."""
    gram, rhs, square = (
        np.sum([getattr(one, name) for one in parts], axis=0) for name in ("gram", "rhs", "square")
    )
    return Noise(gram, rhs, square)


def noisier(arm: Arm, motions: Sequence[Motion], seed: int = 20) -> dict[int, Motion]:
    """Return motions with as much noise again as they have, by their numbers.

    Parameters
    ----------
    arm : Arm
        By its law the noise of the angles is in a torque that was not measured.
    motions : sequence of Motion
    seed : int
        Of the one draw of noise, the same for all models.
    """
    trials = [motion.trial for motion in motions]
    angle = noise_of_angles(trials)
    measured = all("tau" in trial.whole for trial in trials)
    torque = white_noise([trial.whole["tau"] for trial in trials]) if measured else np.zeros(arm.n_joint)
    rng = np.random.default_rng(seed)
    found = {}
    for motion in motions:
        trial = motion.trial
        beyond = settling_samples(trial.dt_s, trial.cutoff_hz) + 3
        size = (len(trial.t) + 2 * beyond, arm.n_joint)

        white = angle * rng.standard_normal(size)
        q, dq, ddq = (_sent(white, order, motion, beyond) for order in range(3))
        if trial.tau is not None:
            u = _sent(torque * rng.standard_normal(size), 0, motion, beyond)
        else:
            u = control_torque(arm.control, q, dq, ddq, np.zeros_like(q))
        found[motion.number] = replace(
            motion,
            q=motion.q + q,
            dq=motion.dq + dq,
            ddq=motion.ddq + ddq,
            speed=motion.speed + dq,
            u=motion.u + u,
        )
    return found


def _sent(white: Floats, order: int, motion: Motion, beyond: int) -> Floats:
    """Return a derivative of noise that went the way of a motion's columns; ``beyond`` more came at each end."""
    trial = motion.trial
    column = lowpass(white, trial.dt_s, trial.cutoff_hz)
    if order:
        column = differentiate(column, trial.dt_s, order)
    return np.asarray(column[beyond:-beyond][:: round(motion.dt_s / trial.dt_s)], dtype=np.float64)


class Design(Protocol):
    """Equations of motions, whatever they are made of."""

    def rows(self, model: Model, motion: Motion) -> Rows:
        """Return a motion's equations under a model."""

    def design_at(self, model: Model, motion: Motion, joint: int) -> Floats:
        """Return what a joint's own equation makes of the columns, by itself."""


class NoiseProducts:
    """What one draw of noise makes of equations.

    Parameters
    ----------
    equations : Design
    noisier : mapping of int to Motion
        The same motions by their numbers, with one draw of noise more.
    """

    def __init__(self, equations: Design, noisier: Mapping[int, Motion]) -> None:
        self._equations, self._noisier = equations, noisier
        self.known: dict[object, Noise] = {}

    def of(self, model: Model, motions: Sequence[Motion], by_joint: bool = False) -> Noise:
        """Return what the draw makes of the equations of some motions under a model.

        Joint by joint if that is asked for, or will be: a drive is held against the noise that it lets through,
        unless it only cuts off (`drive_noise`).
        """
        by_joint = by_joint or model.distorts
        gains = [one.is_gain for one in model.hypotheses]
        if not any(gains) or not model.scales_only:
            return added([self._noise(model, (), by_joint, motion) for motion in motions])
        weak, plain = model.only(gains), model.only([not one for one in gains])
        joints = tuple(hypothesis.joints[0] for hypothesis in weak.hypotheses)
        parts = added([self._noise(plain, joints, by_joint, motion) for motion in motions])
        one = np.eye(parts.rhs.shape[1] // (1 + len(joints)))
        return parts.mixed(np.vstack([one, *(one / psi[0] for psi in weak.psi)]))

    def _noise(self, model: Model, apart: tuple[int, ...], by_joint: bool, motion: Motion) -> Noise:
        parts = zip(model.hypotheses, model.psi, strict=True)
        key = motion.number, apart, by_joint, *((one.part_of(motion), *_key(one, psi)) for one, psi in parts)
        if key not in self.known:
            self.known[key] = self._of(model, apart, by_joint, motion)
        return self.known[key]

    def _of(self, model: Model, apart: tuple[int, ...], by_joint: bool, motion: Motion) -> Noise:
        """Return the noise of columns in parts: by equations of joints not apart, then by each that is."""
        louder, equations = self._noisier[motion.number], self._equations
        rows, loud = (equations.rows(model, one) for one in (motion, louder))
        kept = _noisy_columns(model, rows.columns.white.shape[1])
        target = rows.right.noise_in(loud.right, np.ones(1))
        columns = rows.columns.noise_in(loud.columns, kept)
        if not by_joint:
            return Noise(columns.gram[None], columns.times(target).T, target.gram[0])
        whole = columns.freed
        at = [
            kept * np.subtract(*(equations.design_at(model, one, joint) for one in (louder, motion)))
            for joint in apart
        ]
        both = np.stack([whole - sum(at), *at], axis=1)
        return noise_of(both.reshape(*loud.target.shape, -1), target.freed.reshape(loud.target.shape))


def _noisy_columns(model: Model, n_column: int) -> Floats:
    """Return 1 for every column that is noisy, (n_column,): others hardly are, and change with psi."""
    noisy = np.ones(n_column)
    k = n_column - model.n_column
    for hypothesis, psi in zip(model.hypotheses, model.psi, strict=True):
        if len(psi) or not hypothesis.is_noisy:
            noisy[k : k + hypothesis.n_column] = 0.0
        k += hypothesis.n_column
    return noisy


def _key(hypothesis: Hypothesis, psi: Floats) -> tuple[object, ...]:
    """Return what distinguishes hypotheses by their effect on noise.

    psi hardly matters but where it scales it, or turns the columns among themselves: noise that stayed behind
    would make one zero of a joint seem better than another where they all are the same.
    """
    return hypothesis.key, hypothesis.n_column, psi.tobytes() if hypothesis.mixes_noise else b""
