r"""Noise in the regressor, which would pass for physics: it makes inertias seem smaller, and all else follows.

Angles that were differentiated twice are noisy, so the design is ``A + N``, and least squares answers
``(A^T A + N^T N)^-1 A^T y`` instead of ``(A^T A)^-1 A^T y``: less by the ratio of noise to signal. Little as that
is, it may be several standard errors where many samples tell much. What noise of the size the data have adds to
the normal equations is taken off again (bias-compensated least squares, Stoica and Söderström 1982):

    (A^T A - E[N^T N]) x = A^T y - E[N^T n_y].

The expectation is that of one draw of noise over all trials, sent the way of the data: same filters, same
derivatives, same hypotheses. It has thousands of samples, so it is known to some percent, of a correction that is
a percent itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from arm.control import control_torque
from arm.model import Arm, Floats
from fitter.data.derivatives import differentiate, lowpass, settling_samples
from fitter.diagnosis.motion import Motion, noise_of_angles, white_noise

_SEED = 20
#: No direction loses more than this share of what tells it: where noise is all there is, nothing can be put right.
_MOST = 0.5
#: Columns that are this near to depending on others, in terms of the normal equations, do so.
_DEPENDENT = 1e-12


@dataclass(frozen=True)
class Noise:
    """What one draw of noise makes of equations, joint by joint, or of all joints' together as of one.

    Attributes
    ----------
    gram : (n_joint or 1, k, k)
        Products of what it makes of the columns.
    pull : (n_joint or 1, k)
        Their products with what it makes of the right-hand side.
    own : (n_joint or 1,)
        The sum of squares of that.
    """

    gram: Floats
    pull: Floats
    own: Floats

    def left(self, x: Floats) -> Floats:
        """Return the sum of squares that it leaves at each joint under factors x (k,)."""
        return np.asarray(self.gram @ x @ x - 2.0 * self.pull @ x + self.own, dtype=np.float64)

    def mixed(self, mixing: Floats) -> "Noise":
        """Return the noise of columns that are mixed of these, by a matrix (k, n_column)."""
        return Noise(mixing.T @ self.gram @ mixing, self.pull @ mixing, self.own)


def noise_of(columns: Floats, target: Floats) -> Noise:
    """Return the products of what noise makes of columns (n, n_joint, k) and of a target (n, n_joint)."""
    by_joint, at_joint = columns.transpose(1, 2, 0), target.T[..., None]
    return Noise(by_joint @ by_joint.mT, (by_joint @ at_joint)[..., 0], np.sum(target**2, axis=0))


def added(parts: Sequence[Noise]) -> Noise:
    """Return the noise of several motions together."""
    gram, pull, own = (np.sum([getattr(one, name) for one in parts], axis=0) for name in ("gram", "pull", "own"))
    return Noise(gram, pull, own)


def noisier(arm: Arm, motions: Sequence[Motion]) -> dict[int, Motion]:
    """Return motions with as much noise again as they have, by their numbers.

    Parameters
    ----------
    arm : Arm
        By its law the noise of the angles is in a torque that was not measured.
    motions : sequence of Motion
    """
    trials = [motion.trial for motion in motions]
    angle = noise_of_angles(trials)
    measured = all("tau" in trial.whole for trial in trials)
    torque = white_noise([trial.whole["tau"] for trial in trials]) if measured else np.zeros(arm.n_joint)
    rng = np.random.default_rng(_SEED)
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


def compensated(gram: Floats, pull: Floats, noise_gram: Floats, noise_pull: Floats) -> Floats:
    """Return the answer to normal equations that noise has a part in.

    Parameters
    ----------
    gram, noise_gram : (k, k)
        Of the design, and of what noise makes of it.
    pull, noise_pull : (k,)
        The products with the right-hand side.
    """
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    told, axes = np.linalg.eigh(gram / np.outer(size, size))
    kept = told > _DEPENDENT * max(float(told.max(initial=0.0)), 1e-300)
    root = axes[:, kept] / np.sqrt(told[kept]) / size[:, None]  # root^T gram root = 1
    share, within = np.linalg.eigh(root.T @ noise_gram @ root)
    root = root @ within
    return np.asarray(root @ ((root.T @ (pull - noise_pull)) / (1.0 - np.minimum(share, _MOST))), dtype=np.float64)
