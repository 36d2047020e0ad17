"""The trials of a diagnosis, linearised along a motion, and the normal equations without that motion.

Every sensor has a small bias of its own, as every real one has, held to be no larger than is usual.
"""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from arm.model import STANDARD_GRAVITY_M_S2, Arm, Floats
from fitter.parallel.processors import processors
from fitter.reading_diagnosis.elimination import eliminate, go_back
from fitter.reading_diagnosis.linearisation import Linearisation, instruments_of, linearise
from fitter.reading_diagnosis.sensor_frames import TrialFrames
from fitter.reading_diagnosis.sensor_hypotheses import (
    USUAL_BIAS_M_S2,
    SensorHypothesis,
    Suspect,
    bias_columns,
)


class Trials:
    """The trials of a diagnosis: the first ones are learnt from, the others judge.

    Parameters
    ----------
    arm : Arm
    trials : sequence of TrialFrames
    n_learn : int
    anything : float
        Where the offset of a sensor that forgot may begin, and a free base's step from frame to frame [m/s^2].
    anchor : float
        How well an angle is the zero where nothing else says what it is [rad or m].
    """

    def __init__(
        self,
        arm: Arm,
        trials: Sequence[TrialFrames],
        n_learn: int,
        anything: float = 3.0 * STANDARD_GRAVITY_M_S2,
        anchor: float = 1e-3,
    ) -> None:
        self.arm, self.trials, self.n_learn = arm, list(trials), n_learn
        self._anything, self._anchor = anything, anchor
        self.nominal = instruments_of(arm)
        self._anchored = _gauge(self.arm, self.trials[0])

    def nothing(self) -> SensorHypothesis:
        """Return the arm file's own sensors as a hypothesis."""
        n = len(self.arm.sensors)
        return SensorHypothesis((), (), np.zeros((n, 3)), np.zeros(n, dtype=np.bool_))

    def columns(self, at: Linearisation, hypothesis: SensorHypothesis, suspects: Sequence[Suspect]) -> Floats:
        """Return all columns by the biases and some suspects, and the residual: (n, n_row, p), of unit noise."""
        n_joint = self.arm.n_joint
        blocks = [bias_columns(at, s) for s in range(len(hypothesis.bias))]
        blocks += [suspect.columns(at) for suspect in suspects]
        block = np.concatenate(blocks, axis=2)
        X = np.zeros((len(block), block.shape[1] + n_joint, block.shape[2] + 1))
        X[:, : block.shape[1], :-1] = block * at.weight[..., None]
        return X

    def linearised(self, number: int, hypothesis: SensorHypothesis, c: Floats) -> Linearisation:
        """Return a trial along a motion with the sensors of a hypothesis."""
        return linearise(self.trials[number], hypothesis.instruments(self.nominal), c, hypothesis.without)

    def dropped(self, number: int, hypothesis: SensorHypothesis, c: Floats) -> int:
        """Return how many readings of a trial a hypothesis doesn't look at, as those near a level or past its end.

        What is not looked at leaves no residual; a hypothesis must not win by that.
        """
        if not any(suspect.kind.is_blinding for suspect in hypothesis.suspects):
            return 0
        looked_at = self.linearised(number, hypothesis, c).weight > 0.0
        return int(np.count_nonzero((self.trials[number].weight > 0.0) & ~looked_at))

    def eliminated(
        self, number: int, hypothesis: SensorHypothesis, c: Floats, suspects: Sequence[Suspect]
    ) -> tuple[Floats, Floats]:
        """Linearise a trial and eliminate its motion.

        Returns
        -------
        gram : (p, p)
        back : ndarray
            As `elimination.eliminate` leaves them.
        """
        at = self.linearised(number, hypothesis, c)
        X = self.columns(at, hypothesis, suspects)
        S, X[..., -1] = at.motion_rows()
        if number == 0:  # angles that no reading shows are the zero where the run begins
            n_channel = at.weight.shape[1]
            for j in np.flatnonzero(self._anchored):
                S[0, n_channel + j] = 0.0
                S[0, n_channel + j, 3 * j] = 1.0 / self._anchor
                X[0, n_channel + j, -1] = -at.q[0, j] / self._anchor
        E, walk, first = self._walks(at, hypothesis)
        n_joint, m, p = self.arm.n_joint, len(walk), X.shape[2]
        gram = np.empty((p, p))
        back = np.empty((len(X) + 2, n_joint + m, 3 * n_joint + 2 * m + p))
        eliminate(S, E, X, at.trial.dt_s, walk, first, gram, back)
        return gram, back

    def _walks(self, at: Linearisation, hypothesis: SensorHypothesis) -> tuple[Floats, Floats, Floats]:
        n, n_channel = at.weight.shape
        forgetful = np.flatnonzero(np.repeat(at.instruments.corner_hz, 3))
        if hypothesis.without.any():
            forgetful = forgetful[~np.repeat(hypothesis.without, 3)[forgetful]]
        m = len(forgetful) + 3 * hypothesis.free_base
        E, walk, first = np.zeros((n, n_channel + self.arm.n_joint, m)), np.empty(m), np.empty(m)
        for k, channel in enumerate(forgetful.tolist()):
            E[:, channel, k] = at.weight[:, channel]
            step = 2.0 * np.pi * at.instruments.corner_hz[channel // 3] * at.trial.std[channel] * at.trial.dt_s
            walk[k], first[k] = 1.0 / max(step, 1e-7), 1.0 / self._anything
        if hypothesis.free_base:
            E[:, :n_channel, m - 3 :] = at.from_base() * at.weight[..., None]
            walk[m - 3 :] = first[m - 3 :] = 1.0 / self._anything
        return E, walk, first

    def explained(self, number: int, hypothesis: SensorHypothesis, c: Floats) -> Linearisation:
        """Return a trial along a motion; what is expected holds where offsets of forgetful sensors walk."""
        at = self.linearised(number, hypothesis, c)
        E, _, _ = self._walks(at, hypothesis)
        if not E.shape[2]:
            return at
        n_channel = at.weight.shape[1]
        offset = np.einsum("kcm,km->kc", E[:, :n_channel], self.walked(number, at, hypothesis, c))
        return replace(at, expected=at.expected + offset / np.where(at.weight > 0.0, at.weight, 1.0))

    def walked(self, number: int, at: Linearisation, hypothesis: SensorHypothesis, c: Floats) -> Floats:
        """Return what walks along a motion, (n, m): offsets of forgetful sensors, and last a free base."""
        gram, back = self.eliminated(number, hypothesis, c, ())
        n, _, m = self._walks(at, hypothesis)[0].shape
        change, walked = np.zeros_like(c), np.zeros((n, m))
        go_back(back, np.zeros(len(gram) - 1), c.shape[1], change, walked)
        return walked

    def all_eliminated(
        self,
        numbers: Iterable[int],
        hypothesis: SensorHypothesis,
        motions: Sequence[Floats],
        suspects: Sequence[Suspect],
    ) -> list[tuple[Floats, Floats]]:
        """Return what `eliminated` does of several trials, on as many threads as there are processors."""
        some = list(numbers)
        with ThreadPoolExecutor(
            processors(len(some))
        ) as threads:  # sparse solvers run without the interpreter's lock
            return list(
                threads.map(lambda number: self.eliminated(number, hypothesis, motions[number], suspects), some)
            )

    def before(self, hypothesis: SensorHypothesis) -> tuple[Floats, Floats]:
        """Return what is held of all parameters before: mean and standard deviation."""
        mean, std = [np.zeros(hypothesis.bias.size)], [np.full(hypothesis.bias.size, USUAL_BIAS_M_S2)]
        for suspect, value in zip(hypothesis.suspects, hypothesis.values, strict=True):
            neutral = np.array(suspect.kind.neutral)
            mean.append(np.where(np.isfinite(neutral), neutral, value))
            std.append(np.array(suspect.kind.spread))
        return np.concatenate(mean), np.concatenate(std)


def _gauge(arm: Arm, trial: TrialFrames) -> NDArray[np.bool_]:
    """Return the joints whose angle no reading depends on, as that of one that turns about the vertical."""
    rng = np.random.default_rng(0)  # any motion will do
    c = rng.normal(size=(len(trial.values) + 2, arm.n_joint)) * 1e-2
    slope = linearise(trial, instruments_of(arm), c).slope[:, :, : 3 * arm.n_joint : 3]
    found: NDArray[np.bool_] = np.abs(slope).max(axis=(0, 1)) < 1e-9
    return found
