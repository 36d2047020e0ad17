"""Backlash: where a motor is in its gap, and how its link moves while the motor crosses it.

The motor touches the side towards which it pulls. On its way across it passes on no torque, so the link coasts:
its angle and velocity go on smoothly while the motor's do not. Between the instants at which the motor surely
touched, the link's angle is the cubic that joins its angles and velocities there (Hermite). After a rest, in which
the motor's place in its gap is unknown, the link begins to move at contact, and not before.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, gaussian_filter1d

from arm.model import Arm, Floats
from fitter.data.derivatives import both_derivatives, lowpass
from fitter.data.trial import Trial
from fitter.diagnosis.cutoff import white_noise
from fitter.diagnosis.least_squares import BLOCK_S, EQUAL_SIGMAS, SIGMAS
from fitter.diagnosis.motion import Motion, sharp_torque
from fitter.diagnosis.whitening import LASTS_S

#: The torque's sign is determined behind a Gaussian of this width [s]; within it a contact is not certain.
_WIDTH_S = 0.004
#: Gaps of which the link's motion is kept.
_KEPT = 4


@dataclass(frozen=True)
class BacklashPath:
    """The effect of backlash on the angle of one joint, for any gap.

    The link's angle is the measured one plus ``bridge`` less half the gap times ``side``, both (n_whole,), but
    never further from it than half the gap and what noise adds to that, ``shaking`` [rad]: there it is pushed. A
    bridge that leads further away than the whole gap is none: the motor crept on, and took the link along.

    Attributes
    ----------
    trial : Trial
        What was measured, and the filter that its columns passed.
    cut, step : int
        How many samples lie before the trial's first, and how many the motion goes on at a time.
    """

    bridge: Floats
    side: Floats
    shaking: float
    trial: Trial
    cut: int
    step: int
    _changes: dict[float, Floats] = field(default_factory=dict, init=False, repr=False)

    def off(self, gap: float) -> Floats:
        """Return by how much the link's angle differs from the motor's, not filtered, (n_whole,)."""
        sideways, noise = -0.5 * gap * self.side, SIGMAS * self.shaking
        off = np.where(self._bridged(gap), sideways + self.bridge, sideways)
        return np.clip(off, -0.5 * gap - noise, 0.5 * gap + noise)

    def _bridged(self, gap: float) -> NDArray[np.bool_]:
        """Say where the link coasts along a bridge, (n_whole,)."""
        bridged: NDArray[np.bool_] = self.bridge != 0.0
        edges = np.flatnonzero(np.diff(bridged, prepend=False, append=False))
        off = np.abs(self.bridge - 0.5 * gap * self.side)
        for begin, end in zip(edges[::2], edges[1::2], strict=True):
            bridged[begin:end] = off[begin:end].max() <= gap + 2.0 * SIGMAS * self.shaking
        return bridged

    @property
    def crosses(self) -> NDArray[np.bool_]:
        """Where the motor may be anywhere in its gap: the link's motion is guessed there, (n_sample,)."""
        inner = slice(self.cut, self.cut + len(self.trial.t))
        return np.asarray(self.bridge != 0.0)[inner][:: self.step]

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


def backlash_path(arm: Arm, motion: Motion, joint: int) -> BacklashPath:
    """Return where in its gap the motor of a joint is along a motion."""
    trial = motion.trial
    angle = trial.whole.get("q", trial.q)[:, joint]
    torque = sharp_torque(arm, trial)[:, joint]
    torque = torque[(len(torque) - len(angle)) // 2 :][: len(angle)]
    cut = (len(angle) - len(trial.t)) // 2
    step = max(1, round(motion.dt_s / trial.dt_s))
    starts = sorted({cut + round(at * step) for at, _, _ in motion.jumps})
    bridge, side = bridged(angle, torque, starts, trial.dt_s)
    return BacklashPath(bridge, side, float(white_noise([angle[:, None]])[0]), trial, cut, step)


def contact_side(torque: Floats, noise: float, dt_s: float) -> Floats:
    """Return the side that a motor touches, (n_sample,), 0 where it is not sure."""
    width = max(_WIDTH_S / dt_s, 0.5)
    smooth = gaussian_filter1d(torque, width)
    least = SIGMAS * noise / np.sqrt(2.0 * np.sqrt(np.pi) * width)
    around = np.ones(2 * round(EQUAL_SIGMAS * width) + 1, dtype=np.bool_)
    forwards, backwards = (binary_erosion(way * smooth > least, around, border_value=True) for way in (1.0, -1.0))
    return forwards.astype(np.float64) - backwards


def bridged(
    angle: Floats,
    torque: Floats,
    starts: Sequence[int],
    dt_s: float,
    *,
    wanders_s: float = 0.02,
    slope_s: float = 0.03,
    few: int = 5,
    crossing: int = 2,
) -> tuple[Floats, Floats]:
    """Return what a link's crossing adds to a motor's angle, and the side at which the motor is (-1 to 1).

    Parameters
    ----------
    angle, torque : (n_sample,)
        Of the motor.
    starts : sequence of int
        Samples at which some drive was suddenly asked for another torque: what rested, rested till then.
    dt_s : float
    wanders_s : float
        A motor whose torque does not differ significantly from zero for this long may be anywhere in its play;
        after a block's length its link is at rest.
    slope_s : float
        The link's velocity at an end of a crossing is that of a parabola through the angles of so long.
    few : int
        Samples that say whether an angle is still, or how it moves.
    crossing : int
        Samples that a motor takes to cross when nothing holds it.

    Returns
    -------
    (n_sample,), (n_sample,)
    """
    noise = float(white_noise([torque[:, None]])[0])
    touching = contact_side(torque, noise, dt_s)
    for at in starts:  # a large jump is brought forward by more
        touching[max(0, at - round(2 * EQUAL_SIGMAS * _WIDTH_S / dt_s)) : at] = 0.0
    bridge, side = np.zeros((2, len(angle)))
    sure = np.flatnonzero(touching)
    if not len(sure):
        return bridge, side
    sign = touching[sure]
    side += sign[np.clip(np.searchsorted(sure, np.arange(len(angle)), side="right") - 1, 0, None)]
    shaking = float(white_noise([angle[:, None]])[0])
    window, wanders, rests, still_for = (max(3, round(s / dt_s)) for s in (slope_s, wanders_s, BLOCK_S, LASTS_S))
    away = np.diff(sure)
    leaves = np.flatnonzero((away > wanders) | (np.diff(sign) != 0.0))
    runs = np.concatenate([[0], leaves + 1, [len(sure)]])
    for k, leave in enumerate([-1, *leaves]):
        begin, end = int(sure[leave]) if k else 0, int(sure[leave + 1])
        before, after = sign[leave] if k else 0.0, sign[leave + 1]
        last = min(max(int(sure[runs[k + 1] - 1]), end + few), end + window, len(angle) - 1)
        slope = _at_end(angle[end : last + 1], few)[1]
        inner = [at for at in starts if begin + few <= at <= end]
        started = [at for at in inner if np.std(angle[max(begin, at - still_for) : at]) < EQUAL_SIGMAS * shaking]
        if started or not k or end - begin > rests:
            start = max(started, default=begin)
            end = max(end, min(start + crossing, len(angle) - 1)) if started else end
            still, start, where, rest = _rest(
                angle, torque, noise, (begin, start, end), still_for, after, crossing
            )
            if k and not started:  # nothing says when it came to rest
                still = max(begin, start - still_for)
            settled = _rising(np.linspace(0.0, 1.0, max(still - begin, 0)))
            bridge[begin:still] = settled * (where - angle[begin:still])
            side[begin:still] = (before or rest) + (rest - (before or rest)) * settled
            bridge[still:start], side[still:start] = where - angle[still:start], rest
            q0, slope0, begin, before = where, 0.0, start, rest
        else:
            first = max(min(int(sure[runs[k - 1]]), begin - few), begin - window, 0)
            q0, slope0 = _at_end(angle[first : begin + 1][::-1], few)
        if end > begin:
            share = (np.arange(begin, end + 1) - begin) / (end - begin)
            side[begin : end + 1] = before + (after - before) * _rising(share)
            path = _hermite(share, q0, -slope0 * (end - begin), float(angle[end]), slope * (end - begin))
            bridge[begin : end + 1] = path - angle[begin : end + 1]
    return bridge, side


def _rest(
    angle: Floats,
    torque: Floats,
    noise: float,
    span: tuple[int, int, int],
    still_for: int,
    after: float,
    crossing: int,
) -> tuple[int, int, float, float]:
    """Return from which sample a link was still, until when, its motor's angle then, and the side it was at.

    ``span`` is when the motor left a side, was asked to start, and touched the side ``after``. A torque, small but
    steady, that friction holds determines the side. Otherwise the motor was within its gap, and the link moves
    when it is touched.
    """
    begin, start, end = span
    still = max(begin, start - still_for)
    mean = float(torque[still:start].mean()) if start > still else 0.0
    if abs(mean) > SIGMAS * noise / np.sqrt(max(start - still, 1)):
        return still, start, float(angle[still:start].mean()), float(np.sign(mean))
    first = begin + int(np.argmax(np.abs(torque[begin : end + 1]) > SIGMAS * noise))
    # `end` lies behind the touch by what was eroded, so no spike of noise long before it is taken for one.
    touch = min(end, max(first, end - round(2 * EQUAL_SIGMAS * _WIDTH_S / LASTS_S * still_for)) + crossing)
    return still, touch, float(angle[touch]), after


def _hermite(share: Floats, q0: float, slope0: float, q1: float, slope1: float) -> Floats:
    """Return the cubic with these values and slopes at the ends of a way of length one."""
    across, rest = _rising(share), 1.0 - share
    cubic = (1.0 - across) * q0 + share * rest**2 * slope0 + across * q1 - share**2 * rest * slope1
    return np.asarray(cubic, dtype=np.float64)


def _rising(share: Floats) -> Floats:
    return np.asarray(share**2 * (3.0 - 2.0 * share), dtype=np.float64)


def _at_end(angles: Floats, few: int) -> tuple[float, float]:
    """Return the first of some angles and the slope there, a sample: of a parabola, of few of a straight line."""
    order = 2 if len(angles) > 2 * few else min(1, len(angles) - 1)
    slope, value = [0.0, *np.polyfit(np.arange(len(angles)), angles, order)][-2:]
    return float(value), float(slope)
