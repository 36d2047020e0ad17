"""Hypotheses of the drive: delay, lag, saturation and gain between the commanded torque and the joint."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy
from scipy.ndimage import spline_filter1d

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.data.derivatives import lowpass
from fitter.diagnosis.least_squares import ROUNDED
from fitter.diagnosis.model import N_START, ActionOrder, Hypothesis
from fitter.diagnosis.motion import HypotheticalMotion, Motion, sharp_torque


class DriveHypothesis(Hypothesis):
    """An effect with one number, the same at all its joints."""

    @property
    def low(self) -> Floats:
        """Least value, (1,)."""
        return np.array([max(self.kind.parameters[0].low, 1e-6)])

    @property
    def high(self) -> Floats:
        """Greatest value, (1,)."""
        return np.array([self.kind.parameters[0].high])

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the number itself."""
        return np.array(psi)


class Gain(DriveHypothesis):
    """Joints get another fraction of the torque than was asked for."""

    turn = ActionOrder.GAIN
    is_gain = True
    is_gradual = True
    distorts = True
    mixes_noise = True
    #: Gains that are tried first. From far away no slope leads to the right one: the noise left changes with it.
    tried = np.geomspace(1.0 / 3.0, 3.0, 20)

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first, (n_start, 1)."""
        return self.tried[:, None]

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion whose joints resist with another share."""
        factor = hypothetical.factor.copy()
        factor[list(self.joints)] /= psi[0]
        return replace(hypothetical, factor=factor)


class TorqueTransfer(DriveHypothesis):
    """A drive that passes on another torque than was asked for, and changes nothing else."""

    is_inertial = False

    def __init__(self, kind: EffectKind, joints: Sequence[int]) -> None:
        super().__init__(kind, joints)
        #: The last view and psi of each motion, and what came of its torque.
        self._last: dict[int, tuple[HypotheticalMotion, Floats, Floats]] = {}

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion whose joints get another torque."""
        return replace(hypothetical, u=self._passed(hypothetical, psi))

    def _passed(self, hypothetical: HypotheticalMotion, psi: Floats) -> Floats:
        """Return the torque that arrives, (n_sample, n_joint): the same array as long as nothing of it changes.

        Angles and gravity do not enter it, and while they are sought it need not be made anew.
        """
        if (last := self._last.get(id(hypothetical.motion))) is not None:
            was, at, passed = last
            same = (
                was.motion is hypothetical.motion
                and was.u is hypothetical.u
                and np.array_equal(was.factor, hypothetical.factor)
            )
            if same and np.array_equal(at, psi):
                return passed
        u = hypothetical.u.copy()
        u[:, self.joints] = self.passed(hypothetical, float(psi[0]))
        self._last[id(hypothetical.motion)] = hypothetical, np.array(psi), u
        return u

    @abstractmethod
    def passed(self, hypothetical: HypotheticalMotion, number: float) -> Floats:
        """Return what arrives at its joints, (n_sample, n_own_joint)."""


class Limit(TorqueTransfer):
    """A drive whose torque saturates; in few trials, maybe, and in none of the learning trials."""

    turn = ActionOrder.LIMIT
    is_limit = True
    is_event = True
    depends_on_torque = True

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first, (n_start, 1): they cut off shares of samples, three a decade."""
        u = np.concatenate([np.abs(motion.u[:, self.joints]) for motion in motions])
        starts = np.quantile(u, 1.0 - 10.0 ** (-np.arange(1.0, N_START + 1.0) / 3.0))
        return np.asarray(np.maximum(starts, self.low)[:, None], dtype=np.float64)

    def passed(self, hypothetical: HypotheticalMotion, number: float) -> Floats:
        """Return what arrives at its joints, (n_sample, n_own_joint)."""
        return _limited(hypothetical, self.joints, number)


class Latency(TorqueTransfer):
    """A drive whose torque comes late or slowly."""

    turn = ActionOrder.LATENCY
    distorts = True

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first, (n_start, 1)."""
        step = motions[0].trial.dt_s
        return np.geomspace(step, min(0.15, float(self.high[0])), N_START)[:, None]

    def passed(self, hypothetical: HypotheticalMotion, number: float) -> Floats:
        """Return what arrives at its joints, (n_sample, n_own_joint)."""
        late = [self.late(hypothetical.u[:, j], number, hypothetical.motion.dt_s) for j in self.joints]
        return np.stack(late, axis=1)

    @abstractmethod
    def late(self, u: Floats, number: float, dt_s: float) -> Floats:
        """Return what comes of a torque (n_sample,)."""


class Delay(Latency):
    """A drive whose torque comes late."""

    def late(self, u: Floats, number: float, dt_s: float) -> Floats:
        """Return what comes of a torque (n_sample,)."""
        return delayed(u, number, dt_s)


class Lag(Latency):
    """A drive whose torque follows slowly."""

    def late(self, u: Floats, number: float, dt_s: float) -> Floats:
        """Return what comes of a torque (n_sample,)."""
        return lagging(u, number, dt_s)


def delayed(u: Floats, delay_s: float, dt_s: float) -> Floats:
    """Return a torque that comes late; before its first sample it was what it is there."""
    late = _shifted(u, delay_s / dt_s)
    late[: math.ceil(delay_s / dt_s)] = u[0]
    return late


def _shifted(u: Floats, samples: float) -> Floats:
    """Return a torque delayed by some samples, by a cubic spline that goes on at both ends as it is there."""
    return _at_shifts(u, [samples])[0]


def _at_shifts(u: Floats, shifts: Sequence[float]) -> list[Floats]:
    """Return the same for several shifts, of one spline: four of its weights each, by the cubic B-spline."""
    # What a cubic spline does at a sample falls by 2 - sqrt(3) with each further one: to rounding in this many.
    reach = math.ceil(np.log(ROUNDED) / np.log(2.0 - np.sqrt(3.0)))
    beyond = min(math.ceil(max(abs(samples) for samples in shifts)) + reach, len(u) - 1)
    whole = np.concatenate([2.0 * u[0] - u[beyond:0:-1], u, 2.0 * u[-1] - u[-2 : -beyond - 2 : -1]])
    weights, found = spline_filter1d(whole, order=3), []
    for samples in shifts:
        back = math.floor(-samples)
        f = -samples - back
        first = beyond + back - 1
        weight_of = (1.0 - f) ** 3, 4.0 - 6.0 * f**2 + 3.0 * f**3, 1.0 + 3.0 * f + 3.0 * f**2 - 3.0 * f**3, f**3
        places = (np.arange(first + k, first + k + len(u)) for k in range(len(weight_of)))
        parts = (b * weights.take(at, mode="clip") for b, at in zip(weight_of, places, strict=True))
        found.append(np.asarray(sum(parts) / 6.0, dtype=np.float64))
    return found


def lagging(u: Floats, time_constant_s: float, dt_s: float, fine_s: float = 0.002) -> Floats:
    """Return a torque that follows slowly: ``T x' = u - x``, u a cubic spline.

    It is taken to be straight between samples that are no more than ``fine_s`` apart.
    """
    parts = max(1, math.ceil(dt_s / fine_s))
    between = _at_shifts(u, [-k / parts for k in range(1, parts)]) if parts > 1 else []
    fine = np.stack([u, *between], axis=1).ravel()
    h = dt_s / parts / time_constant_s
    fade = np.exp(-h)
    new = 1.0 - (1.0 - fade) / h  # exact for a ramp
    old = (1.0 - fade) - new
    followed, _ = scipy.signal.lfilter([new, old], [1.0, -fade], fine, zi=[u[0] * (1.0 - new)])
    return np.asarray(followed[::parts], dtype=np.float64)


def _limited(hypothetical: HypotheticalMotion, joints: tuple[int, ...], limit: float) -> Floats:
    """Return torques that were cut off where they are as sharp as they were, and then filtered as columns are.

    A gain comes before the limit.
    """
    trial, motion = hypothetical.motion.trial, hypothetical.motion
    whole = sharp_torque(hypothetical.arm, trial)[:, joints]
    limits = limit * hypothetical.factor[list(joints)]
    cut = lowpass(np.clip(whole, -limits, limits) - whole, trial.dt_s, trial.cutoff_hz)
    inner = cut[trial.trimmed : trial.trimmed + len(trial.t)]
    return np.asarray(hypothetical.u[:, joints] + inner[:: round(motion.dt_s / trial.dt_s)], dtype=np.float64)
