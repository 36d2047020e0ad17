"""Pulses: torques of some duration that stand in no column, found in the residual of the torque equation.

A pulse is sought at every instant with every duration, by its evidence against the coloured background with
Student's tails (`background`): the likelihood ratio integrated over a prior of its size, with all places equally
likely beforehand. Whatever the background's tails, it exceeds odds of a hundred to one by chance no more often
than once in a hundred searches (Markov's inequality: its mean under the background is one).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, minimize

from arm.model import Floats
from fitter.data.derivatives import lowpass
from fitter.diagnosis.evidence import ODDS_NATS
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Background, Rows, estimated, log_likelihood
from fitter.diagnosis.torque.kalman import Filter, innovations
from fitter.diagnosis.torque.missing_torque import ResidualTorque
from limbcal.compiled import compiled

_FORMS = ("rectangular", "bell")
#: Ratio of durations sought: two an octave, neighbours correlated by 0.84.
_DURATION_RATIO = np.sqrt(2.0)
#: Reweightings of the estimate of a size in Student's noise, at the most, and its change that ends them.
_N_REWEIGHTED, _SIZED = 15, 1e-3
#: A place is found when it moves by less than this ratio of the duration, its likelihood ratio by less [nats].
_PLACED = 0.01
#: Digits to which a step is rounded [s]: a nanosecond is nothing.
_STEP_DIGITS = 9
#: Steps of the derivative by start and duration, as a ratio to the duration.
_STEP = 0.05


@dataclass(frozen=True)
class Pulse:
    """A torque of some duration at one joint.

    Attributes
    ----------
    trial, joint : int
    start_s, duration_s : float [s]
        From when to when it is at more than half its size.
    torque_N_m : float [N m]
        Its greatest value.
    start_std, duration_std, torque_std : float
        Standard errors.
    form : str
        ``rectangular``, or ``bell``: a raised cosine.
    log_likelihood_ratio, evidence : float [nats]
        Under the background in which it was found: at its likeliest, and integrated over the prior of its size and
        summed over all places in its trial.
    """

    trial: int
    joint: int
    start_s: float
    duration_s: float
    torque_N_m: float
    start_std: float
    duration_std: float
    torque_std: float
    form: str
    log_likelihood_ratio: float
    evidence: float


def pulse_means(t: Floats, step_s: float, start_s: float, duration_s: float, form: str) -> Floats:
    """Return the means of a pulse of size one over the steps about each instant, (n,)."""

    def area(until: Floats) -> Floats:
        if form == "rectangular":
            return np.clip(until - start_s, 0.0, duration_s)
        u = np.clip((until - start_s) / (2.0 * duration_s) + 0.25, 0.0, 1.0)
        return np.asarray(duration_s * (u - np.sin(2.0 * np.pi * u) / (2.0 * np.pi)))

    return np.asarray((area(t + 0.5 * step_s) - area(t - 0.5 * step_s)) / step_s)


def seen(rows: Rows, start_s: float, duration_s: float, form: str) -> tuple[int, Floats]:
    """Return a pulse of size one as rows see it: behind their low-pass filter, as means over each row's samples.

    Returns
    -------
    first : int
        The first row that it touches.
    column : (m,)
        From there on, as long again as it lasts after its end: what follows from it in the background.
    """
    period_s = 1.0 / rows.band_hz  # so far the filter reaches
    first_s, last_s = _reach(start_s, duration_s, form)
    first, last = np.searchsorted(rows.t, [first_s - period_s, last_s + period_s])
    step_s = rows.step_s / rows.n_sample
    n_sample = (last - first) * rows.n_sample
    begin_s = rows.t[0] + (first - 0.5) * rows.step_s + 0.5 * step_s
    samples = pulse_means(begin_s + step_s * np.arange(n_sample), step_s, start_s, duration_s, form)
    passed = lowpass(samples, step_s, rows.band_hz) if n_sample else samples
    return int(first), np.asarray(passed.reshape(-1, rows.n_sample).mean(axis=1))


def _column(rows: Rows, start_s: float, duration_s: float, form: str) -> Floats:
    """Return a pulse of size one in all rows, (n,)."""
    column = np.zeros(len(rows.t))
    first, part = seen(rows, start_s, duration_s, form)
    column[first : first + len(part)] = part
    return column


def find_pulses(trials: Sequence[ResidualTorque]) -> list[Pulse]:
    """Return the pulses in all trials, ordered by trial, joint and start.

    Parameters
    ----------
    trials : sequence of ResidualTorque

    Returns
    -------
    list of Pulse
    """
    joints = [[trial.rows(joint) for trial in trials] for joint in range(trials[0].r.shape[1])]
    found = [pulse for joint, rows in enumerate(joints) for pulse in _at_joint(rows, joint, len(joints))]
    return sorted(found, key=lambda pulse: (pulse.trial, pulse.joint, pulse.start_s))


def _at_joint(rows: Sequence[Rows], joint: int, n_joint: int) -> list[Pulse]:
    """Return one joint's pulses.

    Pulses that are taken for background hide each other. So all that are likelier than not are taken out, and the
    background is estimated anew, as long as that shows more. Of these, those are found that are so likely as any
    cause must be, each held against the background that is likeliest without it.
    """
    known = np.concatenate([part.r[part.known] for part in rows])
    size = float(np.sqrt(np.sum(known**2) / max(len(known), 1))) or 1.0
    n_place = n_joint * sum(int(np.count_nonzero(_Shapes.of(part).fit(part))) for part in rows)
    background, likely = estimated(rows), list[Pulse]()
    while True:
        nu = background.degrees_of_freedom
        searches = [_Search(k, joint, part, background.filtered(part), nu, size) for k, part in enumerate(rows)]
        least = _log_places(n_place, len(likely) + 1)
        more = [pulse for search in searches for pulse in search.found(least)]
        if len(more) <= len(likely):
            break
        likely = more
        background = estimated(_without(rows, likely), background)
    least = _log_places(n_place, len(likely)) + ODDS_NATS
    return [pulse for pulse in likely if _worth(rows, likely, pulse, background) > least]


def _log_places(n_place: int, k: int) -> float:
    """Return how many more sets of places there are for k pulses than for one fewer, as a logarithm.

    All sets of so many pulses are equally likely beforehand, and that there are k of them with 1 / (k (k + 1)).
    """
    if k == 0:
        return 0.0
    more = (k + 1.0) / (k - 1.0) if k > 1 else 2.0
    return float(np.log(max(n_place - k + 1, k) / k * more))


def _worth(rows: Sequence[Rows], pulses: Sequence[Pulse], one: Pulse, background: Background) -> float:
    """Return what one of some pulses is worth, its places left aside [nats].

    Parameters
    ----------
    rows : sequence of Rows
    pulses : sequence of Pulse
    one : Pulse
    background : Background
        The likeliest without all of them.
    """
    alone = _without(rows, [pulse for pulse in pulses if pulse is not one])
    gain = log_likelihood(background, _without(rows, pulses)) - log_likelihood(estimated(alone, background), alone)
    return gain + one.evidence - one.log_likelihood_ratio


def _without(rows: Sequence[Rows], pulses: Sequence[Pulse]) -> list[Rows]:
    """Return the residuals of the trials without some pulses."""
    left = [replace(part, r=part.r.copy()) for part in rows]
    for pulse in pulses:
        part = left[pulse.trial]
        place = pulse.start_s, pulse.duration_s, pulse.form
        part.r[:] -= pulse.torque_N_m * _column(part, *place)
    return left


class _Shapes:
    """Pulses of size one of all durations and forms that begin with a row, as means over the rows about it.

    Attributes
    ----------
    duration_s, form
        Of each, [s].
    values : (n_shape, n_longest)
    before, length, lasting : (n_shape,)
        From how many rows before the one it begins with, over how many rows, a pulse is felt; how many it lasts.
    """

    def __init__(self, step_s: float, n_sample: int, band_hz: float) -> None:
        pairs = [(float(duration_s), form) for duration_s in _durations(step_s) for form in _FORMS]
        self.duration_s, self.form = [list(part) for part in zip(*pairs, strict=True)]
        self.lasting = np.array([round(duration_s / step_s) for duration_s, _ in pairs])
        n = int(np.ceil((3.0 * LONGEST_PULSE_S + 2.0 / band_hz) / step_s))  # either side: no end cuts a pulse
        t = step_s * np.arange(-n, n + 1, dtype=np.float64)
        rows = Rows(t, 0.0 * t, np.ones(len(t), dtype=np.bool_), t[:, None], n_sample, band_hz, 0.0, 0.0)
        parts = [seen(rows, -0.5 * step_s, *pair) for pair in pairs]
        self.before = np.array([n - first for first, _ in parts])
        self.length = np.array([len(part) for _, part in parts])
        self.values = np.zeros((len(pairs), int(self.length.max())))
        for row, (_, part) in zip(self.values, parts, strict=True):
            row[: len(part)] = part

    @classmethod
    def of(cls, rows: Rows) -> "_Shapes":
        """Return the shapes of some rows: made once for all of the same step."""
        return _shapes(round(rows.step_s, _STEP_DIGITS), rows.n_sample, rows.band_hz)

    def fit(self, rows: Rows) -> NDArray[np.bool_]:
        """Say with which rows a pulse may begin, (n_shape, n): where all that it lasts is known."""
        n = len(rows.t)
        unknown = np.concatenate([[0], np.cumsum(~rows.known)])
        begin = np.arange(n)
        end = begin + self.lasting[:, None]
        return np.asarray((end < n) & (unknown[np.minimum(end, n)] == unknown[begin]), dtype=np.bool_)


@cache
def _shapes(step_s: float, n_sample: int, band_hz: float) -> _Shapes:
    return _Shapes(step_s, n_sample, band_hz)


class _Search:
    """All places for a pulse in one trial at one joint."""

    def __init__(self, trial: int, joint: int, rows: Rows, kalman: Filter, nu: float, size: float) -> None:
        self.trial, self.joint, self.rows, self.kalman, self.nu, self.size = trial, joint, rows, kalman, nu, size
        self.shapes = _Shapes.of(rows)
        self.fit = self.shapes.fit(rows)

    def evidence(self, e: Floats) -> Floats:
        """Return the log evidence for a pulse of each shape that begins with each row, (n_shape, n) [nats]."""
        k, s = self.kalman, self.shapes
        pulses = s.values, s.before, s.length, self.fit
        return np.asarray(_evidence(e, k.F, k.C, k.gain, k.S, k.known, *pulses, self.nu, self.size))

    def found(self, least: float) -> Iterator[Pulse]:
        """Yield the pulses whose evidence exceeds the least, the most evident first.

        What overlaps one of them is its own form, which is neither a rectangle nor a bell, and no other pulse.
        """
        e = self.kalman.innovations(self.rows.r)
        while self.fit.any():
            at_places = self.evidence(e)
            shape, row = np.unravel_index(int(np.argmax(at_places)), at_places.shape)
            evidence = float(np.logaddexp.reduce(at_places, axis=None))
            if evidence < least:
                return
            place = float(self.rows.t[row]) - 0.5 * self.rows.step_s, self.shapes.duration_s[shape]
            pulse = max(
                (self._refined(e, *place, form, evidence) for form in _FORMS),
                key=lambda pulse: pulse.log_likelihood_ratio,
            )
            yield pulse
            self.fit &= ~self._overlapping(pulse)
            column = _column(self.rows, pulse.start_s, pulse.duration_s, pulse.form)
            e = e - self.kalman.innovations(pulse.torque_N_m * column)

    def _overlapping(self, pulse: Pulse) -> NDArray[np.bool_]:
        """Say which places, (n_shape, n), have to do with a pulse, however slowly it rises and falls."""
        begin = self.rows.t - 0.5 * self.rows.step_s
        end = begin + np.array(self.shapes.duration_s)[:, None]
        slope = 0.5 * pulse.duration_s
        return np.asarray(
            (end > pulse.start_s - slope) & (begin < pulse.start_s + pulse.duration_s + slope), dtype=np.bool_
        )

    def _refined(self, e: Floats, start_s: float, duration_s: float, form: str, evidence: float) -> Pulse:
        """Return a pulse at its likeliest start and duration, with standard errors from Fisher's information."""
        h = self.rows.step_s

        def at(place: Floats) -> tuple[float, float]:
            start, lasting = start_s + duration_s * place[0], duration_s * np.exp(place[1])
            first, column = seen(self.rows, start, lasting, form)
            return _ratio(e[first : first + len(column)], self.kalman.innovations(column, first), self.nu)[:2]

        steps = [[0.0, 0.0], [0.25, 0.0], [0.0, 0.25]]
        low, high = np.log([h / duration_s, LONGEST_PULSE_S / duration_s])
        bounds = Bounds([-1.0, min(low, 0.0)], [1.0, max(high, 0.0)])
        options = {"initial_simplex": steps, "xatol": _PLACED, "fatol": _PLACED}

        def loss(place: Floats) -> float:
            return -at(place)[0]

        best = minimize(loss, np.zeros(2), method="Nelder-Mead", bounds=bounds, options=options)  # type: ignore[call-overload]
        ratio, size = at(best.x)
        start, lasting = start_s + duration_s * float(best.x[0]), duration_s * float(np.exp(best.x[1]))
        errors = self._errors(start, lasting, form, size)
        return Pulse(self.trial, self.joint, start, lasting, size, *errors, form, ratio, evidence)

    def _errors(self, start_s: float, duration_s: float, form: str, size: float) -> tuple[float, float, float]:
        """Return standard errors of start, duration and size; Fisher's information of Student's location."""
        step, rows = _STEP * duration_s, self.rows
        ends = [(s, d) for s in (-step, step) for d in (0.0,)] + [(0.0, -step), (0.0, step)]
        moved = [_column(rows, start_s + s, duration_s + d, form) for s, d in ends]
        columns = [
            size * (moved[1] - moved[0]) / (2.0 * step),
            size * (moved[3] - moved[2]) / (2.0 * step),
            _column(rows, start_s, duration_s, form),
        ]
        J = np.stack([self.kalman.innovations(column) for column in columns], axis=1)
        information = (self.nu + 1.0) / (self.nu + 3.0) * J.T @ J
        if np.linalg.matrix_rank(information, hermitian=True) < len(information):
            return np.inf, np.inf, np.inf  # most of the pulse lies where nothing is known
        variance = np.diag(np.linalg.inv(information))
        return tuple(np.sqrt(np.maximum(variance, 0.0)).tolist())


def _durations(step_s: float) -> Floats:
    """Return the durations that are sought [s]: from a period of the band's corner, two rows, to the longest.

    What is shorter has no duration in this band.
    """
    n = 1 + max(0, int(np.log(LONGEST_PULSE_S / (2.0 * step_s)) / np.log(_DURATION_RATIO)))
    return np.asarray(2.0 * step_s * _DURATION_RATIO ** np.arange(n))


def _reach(start_s: float, duration_s: float, form: str) -> tuple[float, float]:
    """Return from when to when a pulse is felt [s]: its torque, and as long as it lasts what follows from it."""
    beyond = 0.0 if form == "rectangular" else 0.5 * duration_s
    return start_s - beyond, start_s + 2.0 * duration_s + beyond


@compiled
def _evidence(
    e: Floats,
    F: Floats,
    C: Floats,
    gain: Floats,
    S: Floats,
    known: NDArray[np.bool_],
    shapes: Floats,
    before: NDArray[np.int64],
    length: NDArray[np.int64],
    fit: NDArray[np.bool_],
    nu: float,
    size: float,
) -> Floats:
    """Return the log evidence of each shape at each row, with Cauchy's prior of a pulse's size, eq. (m.2)."""
    n_shape, n = fit.shape
    evidence = np.full((n_shape, n), -np.inf)
    template = np.zeros(shapes.shape[1])
    for i in range(n_shape):
        for k in range(n):
            if not fit[i, k]:
                continue
            first, last = max(0, k - before[i]), min(n, k - before[i] + length[i])
            cut = first - (k - before[i])
            s = template[: last - first]
            innovations(F, C, gain, S, known, shapes[i, cut : cut + last - first], first, s)
            ratio, c, information = _ratio(e[first:last], s, nu)
            width = 0.5 * np.log(2.0 * np.pi / information)  # of the likelihood, by Laplace
            evidence[i, k] = ratio + width - np.log(np.pi * size * (1.0 + (c / size) ** 2))
    return evidence


@compiled
def _ratio(e: Floats, s: Floats, nu: float) -> tuple[float, float, float]:
    """Return the log likelihood ratio of ``e = c s + Student's noise`` against c = 0, c, and the information on c.

    By reweighting.
    """
    c, square = 0.0, 0.0
    for step in range(_N_REWEIGHTED):
        before, product, square = c, 0.0, 1e-300
        for i in range(len(e)):
            miss = e[i] - c * s[i]
            weight = 1.0 if step == 0 else (nu + 1.0) / (nu + miss * miss)
            product += weight * e[i] * s[i]
            square += weight * s[i] * s[i]
        c = product / square
        if step > 0 and abs(c - before) < _SIZED * abs(c):
            break
    ratio = 0.0
    for i in range(len(e)):
        miss = e[i] - c * s[i]
        ratio += np.log((nu + e[i] * e[i]) / (nu + miss * miss))
    return 0.5 * (nu + 1.0) * ratio, c, square
