"""What one draw of noise makes of the equations under a model, computed once for what it hardly depends on.

A drive with a limit lets less through, by how much of the torque it cuts off.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from arm.model import Floats
from fitter.diagnosis.attenuation import Noise, added, noise_of
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.rows import Equations
from fitter.diagnosis.view import View

#: A torque that another differs from by this share of its rms is cut off.
_CUT = 0.01


class NoisyRows:
    """What one draw of noise makes of equations.

    Parameters
    ----------
    equations : Equations
    noisier : mapping of int to Motion
        The same motions by their numbers, with one draw of noise more.
    """

    def __init__(self, equations: Equations, noisier: Mapping[int, Motion]) -> None:
        self._equations, self._noisier = equations, noisier
        self.known: dict[object, Noise] = {}

    def of(self, model: Model, motions: Sequence[Motion], by_joint: bool = False) -> Noise:
        """Return what the draw makes of the equations of some motions under a model.

        Joint by joint if that is asked for, or will be: a drive is held against the noise that it lets through,
        unless it only cuts off (`let_through`).
        """
        by_joint = by_joint or model.distorts
        gains = [one.is_gain for one in model.hypotheses]
        if not any(gains) or not model.scales_only:
            return added([self._noise(model, (), by_joint, motion) for motion in motions])
        weak, plain = model.only(gains), model.only([not one for one in gains])
        joints = tuple(hypothesis.joints[0] for hypothesis in weak.hypotheses)
        parts = added([self._noise(plain, joints, by_joint, motion) for motion in motions])
        one = np.eye(parts.pull.shape[1] // (1 + len(joints)))
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
    """Return what tells hypotheses apart by what they make of noise.

    psi hardly matters but where it scales it, or turns the columns among themselves: noise that stayed behind
    would make one zero of a joint seem better than another where they all are the same.
    """
    return hypothesis.key, hypothesis.n_column, psi.tobytes() if hypothesis.mixes_noise else b""


def let_through(views: Sequence[View], motions: Sequence[Motion]) -> Floats:
    """Return the share of each joint's torque squared that a limit lets through, (n_joint,).

    It counts as far as the limit is reached: of a torque that is cut off now and then nearly all noise stays.

    Parameters
    ----------
    views : sequence of View
        Motions as they are under the limit.
    motions : sequence of Motion
        The same as measured.
    """
    asked, reaches, cut, moving = np.zeros((4, motions[0].u.shape[1]))
    for view, motion in zip(views, motions, strict=True):
        moves = ~motion.stuck
        asked += np.sum(motion.u**2 * moves, axis=0)
        reaches += np.sum(view.u**2 * moves, axis=0)
        off = np.abs(view.u - motion.u) > _CUT * np.sqrt(np.mean(motion.u**2, axis=0))
        cut += np.sum(off & moves, axis=0)
        moving += np.sum(moves, axis=0)
    through = np.clip(reaches / np.maximum(asked, 1e-300), 1e-12, 1.0)
    return np.asarray(through ** (cut / np.maximum(moving, 1.0)), dtype=np.float64)
