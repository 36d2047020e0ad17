"""Effects between the torque that is asked for and the joint: it comes late, slowly, cut off or too large."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import spline_filter1d
from scipy.signal import lfilter

from arm.effects.effect import EffectKind
from arm.model import Floats
from fitter.data.derivatives import lowpass
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.motion import Motion, sharp_torque
from fitter.diagnosis.view import View

_GRID = 10
#: What a spline does does not reach further than so many samples (to 1e-7).
_SPLINE = 12
#: What follows a torque slowly is computed in steps no longer than this [s].
_FINE_S = 0.002
#: A limit may be this share of the torque that is hardly ever exceeded, or between that and the greatest.
_USUAL = 0.9995
_LIMITS, _ABOVE = np.linspace(0.98, 0.3, 12), np.array([0.8, 0.5, 0.2])
#: Gains that are tried first. From far away no slope leads to the right one: what noise leaves changes with it.
_GAINS = np.geomspace(1.0 / 3.0, 3.0, 20)


class InDrive(Hypothesis):
    """An effect with one number, the same at all its joints."""

    def __init__(self, kind: EffectKind, joints: Sequence[int]) -> None:
        super().__init__(kind, joints)
        #: The last view and psi of each motion, and what came of its torque.
        self._last: dict[int, tuple[View, Floats, Floats]] = {}

    @property
    def is_gradual(self) -> bool:  # type: ignore[override]
        """A gain is, what comes late is not."""
        return self.kind.name == "gain_error"

    @property
    def is_inertial(self) -> bool:  # type: ignore[override]
        """A gain scales masses; what else the drive does changes the torque only."""
        return self.is_gradual

    @property
    def is_event(self) -> bool:  # type: ignore[override]
        """A limit may be reached in few trials, and in none of those that are learnt from."""
        return self.kind.name == "torque_saturation"

    @property
    def low(self) -> Floats:
        """Least value, (1,)."""
        return np.array([max(self.kind.parameters[0].low, 1e-6)])

    @property
    def high(self) -> Floats:
        """Greatest value, (1,)."""
        return np.array([self.kind.parameters[0].high])

    def starts(self, motions: Sequence[Motion]) -> Floats:
        """Return values to try first, (n_start, 1)."""
        if self.kind.name == "torque_saturation":
            u = np.concatenate([np.abs(motion.u[:, self.joints]) for motion in motions])
            usual, most = float(np.quantile(u, _USUAL)), float(u.max())
            starts = np.concatenate([usual + _ABOVE * (most - usual), _LIMITS * usual])
            return np.asarray(starts[:, None], dtype=np.float64)
        if self.kind.name == "gain_error":
            return _GAINS[:, None]
        step = motions[0].trial.dt_s
        return np.geomspace(step, min(0.15, float(self.high[0])), _GRID)[:, None]

    def act(self, view: View, psi: Floats) -> View:
        """Return a motion whose joints get another torque than was asked for."""
        if self.kind.name == "gain_error":
            factor = view.factor.copy()
            factor[list(self.joints)] /= psi[0]
            return replace(view, factor=factor)
        return replace(view, u=self._passed(view, psi))

    def _passed(self, view: View, psi: Floats) -> Floats:
        """Return the torque that arrives, (n_sample, n_joint): the same array as long as nothing of it changes.

        Angles and gravity do not enter it, and while they are sought it need not be made anew.
        """
        if (last := self._last.get(id(view.motion))) is not None:
            was, at, passed = last
            same = was.motion is view.motion and was.u is view.u and np.array_equal(was.factor, view.factor)
            if same and np.array_equal(at, psi):
                return passed
        u = view.u.copy()
        if self.kind.name == "torque_saturation":
            u[:, self.joints] = _limited(view, self.joints, float(psi[0]))
        else:
            for j in self.joints:
                u[:, j] = _DRIVES[self.kind.name](view.u[:, j], float(psi[0]), view.motion.dt_s)
        self._last[id(view.motion)] = view, np.array(psi), u
        return u

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return the number itself."""
        return np.array(psi)


def delayed(u: Floats, delay_s: float, dt_s: float) -> Floats:
    """Return a torque that comes late; before its first sample it was what it is there."""
    late = _shifted(u, delay_s / dt_s)
    late[: math.ceil(delay_s / dt_s)] = u[0]
    return late


def _shifted(u: Floats, samples: float) -> Floats:
    """Return a cubic spline through a torque, so many samples later, gone on with at both ends as it is there."""
    return _at_shifts(u, [samples])[0]


def _at_shifts(u: Floats, shifts: Sequence[float]) -> list[Floats]:
    """Return the same for several shifts, of one spline: four of its weights each, by the cubic B-spline."""
    beyond = min(math.ceil(max(abs(samples) for samples in shifts)) + _SPLINE, len(u) - 1)
    whole = np.concatenate([2.0 * u[0] - u[beyond:0:-1], u, 2.0 * u[-1] - u[-2 : -beyond - 2 : -1]])
    weights, found = spline_filter1d(whole, order=3), []
    for samples in shifts:
        back = math.floor(-samples)
        f = -samples - back
        first = beyond + back - 1
        hat = (1.0 - f) ** 3, 4.0 - 6.0 * f**2 + 3.0 * f**3, 1.0 + 3.0 * f + 3.0 * f**2 - 3.0 * f**3, f**3
        places = (np.arange(first + k, first + k + len(u)) for k in range(len(hat)))
        parts = (b * weights.take(at, mode="clip") for b, at in zip(hat, places, strict=True))
        found.append(np.asarray(sum(parts) / 6.0, dtype=np.float64))
    return found


def lagging(u: Floats, time_constant_s: float, dt_s: float) -> Floats:
    """Return a torque that follows slowly: ``T x' = u - x``, u a cubic spline, straight between finer samples."""
    parts = max(1, math.ceil(dt_s / _FINE_S))
    between = _at_shifts(u, [-k / parts for k in range(1, parts)]) if parts > 1 else []
    fine = np.stack([u, *between], axis=1).ravel()
    h = dt_s / parts / time_constant_s
    fade = np.exp(-h)
    new = 1.0 - (1.0 - fade) / h  # exact for a ramp
    old = (1.0 - fade) - new
    followed, _ = lfilter([new, old], [1.0, -fade], fine, zi=[u[0] * (1.0 - new)])
    return np.asarray(followed[::parts], dtype=np.float64)


def _limited(view: View, joints: tuple[int, ...], limit: float) -> Floats:
    """Return torques that were cut off where they are as sharp as they were, and then filtered as columns are.

    A gain comes before the limit.
    """
    trial, motion = view.motion.trial, view.motion
    whole = sharp_torque(view.arm, trial)[:, joints]
    limits = limit * view.factor[list(joints)]
    cut = lowpass(np.clip(whole, -limits, limits) - whole, trial.dt_s, trial.cutoff_hz)
    inner = cut[trial.trimmed : trial.trimmed + len(trial.t)]
    return np.asarray(view.u[:, joints] + inner[:: round(motion.dt_s / trial.dt_s)], dtype=np.float64)


_DRIVES = {"actuator_delay": delayed, "actuator_lag": lagging}


def drive_hypotheses(kind: EffectKind, n_joint: int) -> list[Hypothesis]:
    """Return the places where an effect of the drive may be: at one joint, or alike at all."""
    places: list[tuple[int, ...]] = [(j,) for j in range(n_joint)]
    if n_joint > 1 and kind.name in ("actuator_delay", "actuator_lag"):
        places.append(tuple(range(n_joint)))
    return [InDrive(kind, place) for place in places]
