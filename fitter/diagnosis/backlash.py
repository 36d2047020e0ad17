"""Backlash: by how much a link's angle differs from its motor's, for any gap."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.data.derivatives import both_derivatives, lowpass
from fitter.data.trial import Trial
from fitter.diagnosis.contacts import Motor
from fitter.diagnosis.cutoff import white_noise
from fitter.diagnosis.free_link import FreeLink, weightless
from fitter.diagnosis.least_squares import SIGMAS
from fitter.diagnosis.link_coasting import Coasting, coasting
from fitter.diagnosis.motion import Motion, sharp_torque

#: Gaps of which the link's motion is kept.
_KEPT = 4


@dataclass(frozen=True)
class BacklashPath:
    """The effect of backlash on the angle of one joint, for any gap.

    The link's angle is the measured one plus a bridge less half the gap times the motor's side, but never further
    from it than half the gap and what noise adds to that: there it is pushed. A bridge that leads further away
    than the whole gap is none: the motor crept on, and took the link along. Within the gap the link may be
    anywhere, so it follows the bridge as far as that is known better, each weighted by its variance.

    Attributes
    ----------
    coasting : Coasting
        Of the whole trial, (n_whole,).
    shaking : float [rad]
        Standard deviation of an angle's noise.
    trial : Trial
        What was measured, and the filter that its columns passed.
    cut, step : int
        How many samples lie before the trial's first, and how many the motion goes on at a time.
    """

    coasting: Coasting
    shaking: float
    trial: Trial
    cut: int
    step: int
    _changes: dict[float, Floats] = field(default_factory=dict, init=False, repr=False)

    def off(self, gap: float) -> Floats:
        """Return by how much the link's angle differs from the motor's, not filtered, (n_whole,)."""
        sideways, noise = -0.5 * gap * self.coasting.side, SIGMAS * self.shaking
        within = gap**2 / 12.0  # variance of what is uniform within the gap
        weight = within / (within + self.shaking**2 * self.coasting.variance)
        off = sideways + self._credible(gap) * weight * self.coasting.bridge
        return np.clip(off, -0.5 * gap - noise, 0.5 * gap + noise)

    def _credible(self, gap: float) -> Floats:
        """Return how likely it is that a bridge is one and leads too far by its error alone, (n_whole,), 0 to 1.

        It changes smoothly with the gap: a search by slopes would stop where a bridge is suddenly none.
        """
        bridge = self.coasting.bridge
        edges = np.flatnonzero(np.diff(bridge != 0.0, prepend=False, append=False))
        too_far = np.abs(bridge - 0.5 * gap * self.coasting.side) - gap
        sigmas = too_far / (self.shaking * np.sqrt(1.0 + self.coasting.variance))
        credible = np.ones(len(bridge))
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            credible[begin:end] = np.exp(-0.5 * max(sigmas[begin:end].max() - SIGMAS, 0.0) ** 2)
        return credible

    @property
    def crosses(self) -> NDArray[np.bool_]:
        """Where the motor may be anywhere in its gap: the link's motion is guessed there, (n_sample,)."""
        inner = slice(self.cut, self.cut + len(self.trial.t))
        return np.asarray(self.coasting.bridge != 0.0)[inner][:: self.step]

    def change(self, gap: float) -> Floats:
        """Return by how much the link's angle and its derivatives differ from the motor's, (3, n_sample).

        Those of the last gaps are kept: other accelerations are tried along the same path (`mass_density`).
        """
        if gap not in self._changes:
            if len(self._changes) >= _KEPT:
                self._changes.clear()
            self._changes[gap] = self._changed(gap)
        return self._changes[gap]

    def _changed(self, gap: float) -> Floats:
        off, trial = self.off(gap), self.trial
        smooth = lowpass(off, trial.dt_s, trial.cutoff_hz) if self.cut else off
        slopes = both_derivatives(smooth, trial.dt_s)
        inner = slice(self.cut, self.cut + len(trial.t))
        return np.asarray(np.stack([smooth, *slopes])[:, inner][:, :: self.step], dtype=np.float64)


def backlash_path(arm: Arm, motion: Motion, joint: int, link: FreeLink | None = None) -> BacklashPath:
    """Return where in its gap the motor of a joint is along a motion, and what moves its link meanwhile."""
    trial = motion.trial
    angle = trial.whole.get("q", trial.q)[:, joint]
    torque = sharp_torque(arm, trial)[:, joint]
    torque = torque[(len(torque) - len(angle)) // 2 :][: len(angle)]
    cut = (len(angle) - len(trial.t)) // 2
    step = max(1, round(motion.dt_s / trial.dt_s))
    starts = sorted({cut + round(at * step) for at, _, _ in motion.jumps})
    shaking, torque_noise = map(float, white_noise([np.stack([angle, torque], axis=1)]))
    t = motion.t[0] + (np.arange(len(angle)) - cut) * trial.dt_s
    own = weightless(t) if link is None else link.at(t)
    motor = Motor(angle, torque, (shaking, torque_noise), starts, own, trial.dt_s)
    return BacklashPath(coasting(motor), shaking, trial, cut, step)
