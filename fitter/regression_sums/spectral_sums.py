"""Trials reduced to sums of products over bands of frequency, where noise of any colour is independent.

The equation ``W p = tau`` holds while a joint moves. It is averaged over short steps; where the
joint turns round it is bridged by a line between means of the steps before and after; it is multiplied by a window
that is zero where the joint rests and at the trial's ends, and Fourier-transformed: the same linear operations on
both sides, so it stays exact, Coulomb friction included. The coefficients of stationary noise at different
frequencies are independent, whatever its spectrum, and their variance is the spectrum. (Through many holes, where
there are bridges now, strong noise of one frequency would leak into all others.)
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from arm.base_parameters import BaseParameters
from arm.model import Arm, Floats
from arm.regressor import regressor
from fitter.data.bandwidth import Signal, motion_edge_hz
from fitter.data.refilter import CORNER_FACTOR, refiltered
from fitter.data.standstill import REST_SPEED, is_moving, throughout
from fitter.data.torque_target import torque_target
from fitter.data.trial import Trial
from fitter.data.trial_filter import COLUMN_CORNER, lowpass_trial
from fitter.regression_sums.torque_sums import TorqueSums

#: From one band to the next: an eighth of an octave, across which no noise changes much.
_WIDER = 2.0**0.125
#: Factor of the highest frequency of the motion's filter down to which equations are averaged.
_OVERSAMPLED = 4.0
#: Periods of the highest frequency around a rest over which the filter blurs its ends, and periods over which a
#: window rises after them, so that noise above that frequency does not leak down.
_BLURRED_PERIODS, _RISE_PERIODS = 0.5, 0.5
#: A joint that is slow for longer rests [s]; at 0.2 rad/s^2 turning round takes as long.
_TURNING_S = 0.2
#: Fraction of the sampling rate above which a spline's second derivative is off by more than a thousandth.
_DIFFERENTIABLE = 0.15
#: Samples whose regressor is in memory with all its columns.
_CHUNK = 2048
#: Memory of the rows that are transformed at a time; longer trials are cut.
_ROW_BYTES = 64_000_000


@dataclass(frozen=True)
class SpectralSums:
    """Sums of products of the equations' Fourier coefficients.

    Attributes
    ----------
    sums : TorqueSums
        A block is a band of frequency, over all trials; ``count`` is the number of independent real coefficients.
        ``row`` and ``torque`` are not kept.
    frequency_hz : (n_band,)
        The middle of each band.
    """

    sums: TorqueSums
    frequency_hz: Floats


@dataclass(frozen=True)
class _Motion:
    """A trial as its equations see it: its torque, where that says something, and the highest frequency used."""

    trial: Trial
    tau: Floats
    counted: NDArray[np.bool_]
    top_hz: float


def spectral_sums(
    arm: Arm, base: BaseParameters, trials: Sequence[Trial], rest_speed: float = REST_SPEED
) -> SpectralSums:
    """Reduce trials to sums over bands of frequency.

    Parameters
    ----------
    arm : Arm
        Its geometry and gravity; its law where the torque was not measured.
    base : BaseParameters
    trials : sequence of Trial
        Derivatives that were found behind a filter are found anew behind one with twice the corner: noise that
        they let in is weighed here, what a filter bends is not.
    rest_speed : float [rad/s or m/s]
        A joint this slow is taken to be at rest.

    Raises
    ------
    DataError
        If the law is "measured" and a trial has no torque.
    """
    n_joint, n_base = arm.n_joint, len(base.independent)
    motions = [_motion(arm, trial) for trial in trials]
    edges = _edges(max(len(m.trial.t) * m.trial.dt_s for m in motions), max(m.top_hz for m in motions))
    n_band = len(edges) - 1
    gram, moment = np.zeros((n_band, n_joint, n_base, n_base)), np.zeros((n_band, n_joint, n_base))
    power, count = np.zeros((2, n_band, n_joint))
    for motion in motions:
        for rows, window, step_s in _stretches(arm, base, motion, rest_speed):
            frequency = scipy.fft.rfftfreq(len(rows), step_s)
            frequency = frequency[frequency <= motion.top_hz]
            band = np.clip(np.searchsorted(edges, frequency, side="right") - 1, 0, n_band - 1)
            starts = np.flatnonzero(np.diff(band, prepend=-1))
            real = np.where(frequency > 0.0, 2.0, 1.0)  # numbers in a coefficient
            for j in range(n_joint):
                felt = np.flatnonzero(rows[:, j].any(axis=0))
                whole = scipy.fft.rfft(rows[:, j, felt], axis=0)[: len(frequency)]
                whole *= np.sqrt(real / len(rows))[:, None]
                share = float(np.mean(window[:, j] ** 2))
                parameters = felt[felt < n_base]
                k, has_torque = len(parameters), len(felt) > 0 and felt[-1] == n_base
                for first, last in zip(starts, [*starts[1:], len(band)], strict=True):
                    part, b = whole[first:last], band[first]
                    products = part.real.T @ part.real + part.imag.T @ part.imag
                    gram[b, j][np.ix_(parameters, parameters)] += products[:k, :k]
                    if has_torque:
                        moment[b, j, parameters] += products[:k, k]
                        power[b, j] += products[k, k]
                    count[b, j] += share * real[first:last].sum()
    seen = count.any(axis=1)
    sums = TorqueSums(
        gram=gram[seen],
        moment=moment[seen],
        power=power[seen],
        row=np.zeros_like(moment[seen]),
        torque=np.zeros_like(power[seen]),
        count=count[seen],
        trial=np.zeros(int(seen.sum()), dtype=np.intp),
        samples=sum(len(motion.trial.t) for motion in motions),
    )
    return SpectralSums(sums, np.sqrt(edges[:-1] * edges[1:])[seen])


def _motion(arm: Arm, trial: Trial) -> _Motion:
    """Return a trial behind a filter with a wider band, and what drives the arm, unfiltered if it was measured."""
    nyquist = 0.5 / trial.dt_s
    if trial.whole:
        wide = refiltered([trial])[0]
        top_hz = min(wide.cutoff_hz, _DIFFERENTIABLE / trial.dt_s)
    else:
        corner_hz = trial.cutoff_hz
        if not np.isfinite(corner_hz):
            edge_hz = motion_edge_hz([Signal(trial.q, trial.dt_s, 2)])
            corner_hz = nyquist if edge_hz is None else COLUMN_CORNER * edge_hz
        top_hz = min(CORNER_FACTOR * corner_hz, nyquist)
        wide = lowpass_trial(trial, top_hz) if np.isfinite(trial.cutoff_hz) else trial
    whole = trial.whole.get("tau", trial.tau)
    if arm.control.law == "measured" and whole is not None:
        tau = whole[wide.trimmed :][: len(wide.t)]
    else:
        tau = torque_target(arm, wide)
    counted = wide.counted
    if trial.whole and trial.contradicted is not None:  # of what was trimmed before nobody knows
        counted = np.zeros(wide.q.shape, dtype=np.bool_)
        before = trial.trimmed - wide.trimmed
        counted[before : before + len(trial.q)] = trial.counted
    return _Motion(wide, tau, counted, float(top_hz))


def _edges(longest_s: float, top_hz: float) -> Floats:
    """Return edges of bands [Hz], each an eighth of an octave wide or as many bins as it takes."""
    edges = [0.5 / longest_s]
    while edges[-1] < top_hz:
        edges.append(max(edges[-1] * _WIDER, edges[-1] + 1.0 / longest_s))
    return np.array(edges)


def _stretches(
    arm: Arm, base: BaseParameters, motion: _Motion, rest_speed: float
) -> Iterator[tuple[Floats, Floats, float]]:
    """Yield a trial's windowed rows with the torque as last column, their windows, and their step [s]."""
    trial, tau, top_hz = motion.trial, motion.tau, motion.top_hz
    stride = max(1, int(1.0 / (_OVERSAMPLED * top_hz * trial.dt_s)))
    n_step, n_column = len(trial.q) // stride, len(base.independent) + 1
    parts = max(1, -(-n_step * arm.n_joint * n_column * 8 // _ROW_BYTES))
    blurred = round(_BLURRED_PERIODS / (top_hz * trial.dt_s))
    rise = round(_RISE_PERIODS / (top_hz * trial.dt_s * stride))
    longest = round((_TURNING_S / trial.dt_s + 2 * blurred) / stride) + 1
    for steps in np.array_split(np.arange(n_step), parts):
        if not len(steps):
            continue
        part = slice(int(steps[0]) * stride, (int(steps[-1]) + 1) * stride)
        each = _holding(trial.dq[part], motion.counted[part], rest_speed, blurred)
        holds = np.asarray(np.all(each.reshape(-1, stride, arm.n_joint), axis=1), dtype=np.bool_)
        rows = np.empty((len(steps), arm.n_joint, n_column))
        chunk = max(1, _CHUNK // stride)
        for begin in range(0, len(steps), chunk):
            some = slice(begin, min(begin + chunk, len(steps)))
            at = slice(part.start + some.start * stride, part.start + some.stop * stride)
            Y = regressor(arm, trial.q[at], trial.dq[at], trial.ddq[at])[..., base.independent]
            equations = np.concatenate([Y, tau[at][..., None]], axis=2)
            rows[some] = equations.reshape(-1, stride, arm.n_joint, n_column).mean(axis=1)
        yield rows, _patched(rows, holds, longest, rise), stride * trial.dt_s


def _holding(dq: Floats, counted: NDArray[np.bool_], rest_speed: float, blurred: int) -> NDArray[np.bool_]:
    """Return where equations surely hold, (n_sample, n_joint): a joint may turn round between two samples."""
    one_way = np.diff(np.sign(dq), axis=0) == 0.0
    moving = is_moving(dq, rest_speed) & counted
    moving[1:] &= one_way
    moving[:-1] &= one_way
    return throughout(moving, blurred)


def _patched(rows: Floats, holds: NDArray[np.bool_], longest: int, rise: int) -> Floats:
    """Bridge short holes in rows, fade them out at long ones and at the ends, in place.

    Parameters
    ----------
    rows : (n_step, n_joint, n_column)
    holds : (n_step, n_joint) bool
        Where a joint's equation holds.
    longest : int
        The longest hole that is bridged.
    rise : int
        Steps over which rows fade.

    Returns
    -------
    (n_step, n_joint)
        The weights that rows have now; zero for a bridge, which says nothing new.
    """
    n, weights = len(rows), np.empty(holds.shape)
    for j in range(holds.shape[1]):
        edges = np.flatnonzero(np.diff(holds[:, j], prepend=not holds[0, j], append=not holds[-1, j]))
        begins, ends = edges[:-1], edges[1:]
        outside = ~holds[:, j]
        for k in np.flatnonzero(~holds[begins, j]):
            first, last = int(begins[k]), int(ends[k])
            if first == 0 or last == n or last - first > longest:
                continue
            some = max(1, (last - first) // 2)
            before = rows[max(first - some, int(begins[k - 1])) : first, j].mean(axis=0)
            after = rows[last : min(last + some, int(ends[k + 1])), j].mean(axis=0)
            along = (np.arange(last - first) + 1.0)[:, None] / (last - first + 1.0)
            rows[first:last, j] = before + along * (after - before)
            outside[first:last] = False
        bounded = np.concatenate([[True], outside, [True]])
        since = distance_transform_edt(~bounded)[1:-1]
        window = np.sin(0.5 * np.pi * np.minimum(since / (rise + 1.0), 1.0)) ** 2
        rows[:, j] *= window[:, None]
        weights[:, j] = np.where(holds[:, j], window, 0.0)
    return weights
