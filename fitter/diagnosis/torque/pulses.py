"""Pulses: torques of some duration that stand in no column, found in the residual of the torque equation.

A pulse is sought at every instant with every duration, by the likelihood ratio against the coloured background
with Student's tails (`background`). It is found if the background alone reaches its ratio anywhere in all trials
at a small rate only: the distribution of the greatest ratio is simulated from the background itself.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, minimize
from scipy.stats import gumbel_r

from arm.model import Floats
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Rows, estimated
from fitter.diagnosis.torque.kalman import Filter
from fitter.diagnosis.torque.missing_torque import ResidualTorque
from limbcal.compiled import compiled

#: False alarms of a joint [1/s]: half of one in 100 s, the greatest rate of use to a person.
_FALSE_ALARM_RATE = 0.005
_FORMS = ("rectangular", "bell")
#: Ratio of durations sought: two an octave, neighbours correlated by 0.84.
_DURATION_RATIO = np.sqrt(2.0)
#: Simulated backgrounds: they leave Gumbel's scale uncertain by about a tenth.
_N_SIMULATED = 100
#: Reweightings of the estimate of a size in Student's noise.
_N_REWEIGHTED = 15
#: A place is found when it moves by less than this ratio of the duration, its likelihood ratio by less [nats].
_PLACED = 0.01
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
    log_likelihood_ratio : float [nats]
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


def pulse_means(t: Floats, step_s: float, start_s: float, duration_s: float, form: str) -> Floats:
    """Return the means of a pulse of size one over the steps about each instant, (n,)."""

    def area(until: Floats) -> Floats:
        if form == "rectangular":
            return np.clip(until - start_s, 0.0, duration_s)
        u = np.clip((until - start_s) / (2.0 * duration_s) + 0.25, 0.0, 1.0)
        return np.asarray(duration_s * (u - np.sin(2.0 * np.pi * u) / (2.0 * np.pi)))

    return np.asarray((area(t + 0.5 * step_s) - area(t - 0.5 * step_s)) / step_s)


def find_pulses(trials: Sequence[ResidualTorque]) -> list[Pulse]:
    """Return the pulses in all trials, ordered by trial, joint and start.

    Parameters
    ----------
    trials : sequence of ResidualTorque

    Returns
    -------
    list of Pulse
    """
    n_joint = trials[0].r.shape[1]
    found = [pulse for joint in range(n_joint) for pulse in _at_joint(trials, joint)]
    return sorted(found, key=lambda pulse: (pulse.trial, pulse.joint, pulse.start_s))


def _at_joint(trials: Sequence[ResidualTorque], joint: int) -> list[Pulse]:
    """Return one joint's pulses; the background is estimated anew without them, as long as that finds more."""
    rows = [trial.rows(joint) for trial in trials]
    known_s = sum(float(np.sum(part.known)) * part.step_s for part in rows)
    probability = 1.0 - np.exp(-_FALSE_ALARM_RATE * known_s)  # of one false alarm or more, Poisson
    background, found = estimated(rows), list[Pulse]()
    while True:
        nu = background.degrees_of_freedom
        searches = [_Search(k, joint, part, background.filtered(part), nu) for k, part in enumerate(rows)]
        least = _least_ratios(searches, probability)
        more = [pulse for search in searches for pulse in search.found(least)]
        if len(more) <= len(found):
            return found
        found = more
        background = estimated([_without(part, found, k) for k, part in enumerate(rows)], background)


def _without(rows: Rows, pulses: Sequence[Pulse], trial: int) -> Rows:
    """Return the residual of a trial without the pulses found in it."""
    r = rows.r.copy()
    for pulse in pulses:
        if pulse.trial == trial:
            r -= pulse.torque_N_m * pulse_means(rows.t, rows.step_s, pulse.start_s, pulse.duration_s, pulse.form)
    return replace(rows, r=r)


class _Search:
    """All places for a pulse in one trial at one joint, whitened."""

    def __init__(self, trial: int, joint: int, rows: Rows, kalman: Filter, nu: float) -> None:
        self.trial, self.joint, self.rows, self.kalman, self.nu = trial, joint, rows, kalman, nu
        self.places = list(_places(rows))
        self.duration = np.searchsorted(_durations(rows.step_s), [0.999 * place[1] for place in self.places])
        self.first, self.last = np.array([self._reach(*place) for place in self.places]).reshape(-1, 2).T
        self.templates = _packed(self.first, self.last, [self.template(*place) for place in self.places])

    def _reach(self, start_s: float, duration_s: float, form: str) -> tuple[int, int]:
        """Return the first row that a pulse touches, and the last (exclusive) that still feels it."""
        before = duration_s if form == "rectangular" else 1.5 * duration_s
        first, last = np.searchsorted(
            self.rows.t, [start_s - before + duration_s - self.rows.step_s, start_s + duration_s + before]
        )
        return int(first), int(last)

    def template(self, start_s: float, duration_s: float, form: str) -> Floats:
        """Return the innovations of a pulse of size one between the rows of its reach."""
        first, last = self._reach(start_s, duration_s, form)
        column = pulse_means(self.rows.t, self.rows.step_s, start_s, duration_s, form)
        bounds = np.array([first]), np.array([last])
        return self.kalman.whitened(column[:, None], *bounds)[first:last, 0]

    def ratios(self, e: Floats) -> Floats:
        """Return the log likelihood ratio of each place."""
        return np.asarray(_ratios(e, self.templates, self.first, self.last, self.nu))

    def greatest(self, e: Floats) -> Floats:
        """Return the greatest log likelihood ratio of each duration, (n_duration,)."""
        greatest = np.zeros(len(_durations(self.rows.step_s)))
        np.maximum.at(greatest, self.duration, self.ratios(e))
        return greatest

    def found(self, least: Floats) -> Iterator[Pulse]:
        """Yield the pulses whose ratios exceed the least ones of their durations, the greatest excess first."""
        e = self.kalman.innovations(self.rows.r)
        while len(self.places):
            excess = self.ratios(e) - least[self.duration]
            best = int(np.argmax(excess))
            if excess[best] < 0.0:
                return
            start_s, duration_s, _ = self.places[best]
            pulse = max(
                (self._refined(e, start_s, duration_s, form) for form in _FORMS),
                key=lambda pulse: pulse.log_likelihood_ratio,
            )
            yield pulse
            column = pulse_means(self.rows.t, self.rows.step_s, pulse.start_s, pulse.duration_s, pulse.form)
            e = e - self.kalman.innovations(pulse.torque_N_m * column)

    def _refined(self, e: Floats, start_s: float, duration_s: float, form: str) -> Pulse:
        """Return a pulse at its likeliest start and duration, with standard errors from Fisher's information."""

        def at(place: Floats) -> tuple[float, float]:
            start, lasting = start_s + duration_s * place[0], duration_s * np.exp(place[1])
            first, last = self._reach(start, lasting, form)
            return _ratio(e[first:last], self.template(start, lasting, form), self.nu)

        steps = [[0.0, 0.0], [0.25, 0.0], [0.0, 0.25]]
        low, high = np.log([self.rows.step_s / duration_s, LONGEST_PULSE_S / duration_s])
        bounds = Bounds([-1.0, min(low, 0.0)], [1.0, max(high, 0.0)])
        options = {"initial_simplex": steps, "xatol": _PLACED, "fatol": _PLACED}

        def loss(place: Floats) -> float:
            return -at(place)[0]

        best = minimize(loss, np.zeros(2), method="Nelder-Mead", bounds=bounds, options=options)  # type: ignore[call-overload]
        ratio, size = at(best.x)
        start, lasting = start_s + duration_s * float(best.x[0]), duration_s * float(np.exp(best.x[1]))
        errors = self._errors(start, lasting, form, size)
        return Pulse(self.trial, self.joint, start, lasting, size, *errors, form, ratio)

    def _errors(self, start_s: float, duration_s: float, form: str, size: float) -> tuple[float, float, float]:
        """Return standard errors of start, duration and size; Fisher's information of Student's location."""
        step, t, h = _STEP * duration_s, self.rows.t, self.rows.step_s
        ends = [(s, d) for s in (-step, step) for d in (0.0,)] + [(0.0, -step), (0.0, step)]
        moved = [pulse_means(t, h, start_s + s, duration_s + d, form) for s, d in ends]
        columns = np.stack(
            [
                size * (moved[1] - moved[0]) / (2.0 * step),
                size * (moved[3] - moved[2]) / (2.0 * step),
                pulse_means(t, h, start_s, duration_s, form),
            ],
            axis=1,
        )
        reach = np.zeros(3, dtype=np.int64), np.full(3, len(t), dtype=np.int64)
        J = self.kalman.whitened(columns, *reach)
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


def _places(rows: Rows) -> Iterator[tuple[float, float, str]]:
    """Yield start, duration and form of every pulse that is tried: one a row, where its rows are known."""
    t, h = rows.t, rows.step_s
    for duration_s in _durations(h):
        n_row = round(duration_s / h)
        for k in range(len(t) - n_row):
            if rows.known[k : k + n_row].all():
                for form in _FORMS:
                    yield float(t[k]) - 0.5 * h, float(duration_s), form


def _least_ratios(searches: Sequence[_Search], probability: float) -> Floats:
    """Return the log likelihood ratios (n_duration,) that the background exceeds with a given probability.

    Few rows of great error may pass for a short pulse: the shorter, the greater the least ratio. Innovations
    are drawn from the background's Student's distribution. The greatest ratio of each duration in all trials
    follows a Gumbel distribution; so does the greatest of these ratios over all durations, each in its own units.
    """
    rng = np.random.default_rng(0)
    greatest = np.array(
        [
            np.max([s.greatest(rng.standard_t(s.nu, len(s.rows.t)) * s.rows.known) for s in searches], axis=0)
            for _ in range(_N_SIMULATED)
        ]
    )
    modes, scales = _gumbel(greatest)
    over_all = np.max((greatest - modes) / scales, axis=1)
    return np.asarray(modes + scales * gumbel_r.ppf(1.0 - probability, *_gumbel(over_all)))


def _gumbel(values: Floats) -> tuple[Floats, Floats]:
    """Return mode and scale of Gumbel distributions by their mean and standard deviation, along the first axis.

    A duration that no place has room for has ratios of zero only, and no scale: it alarms nobody.
    """
    scale = np.maximum(values.std(axis=0) * np.sqrt(6.0) / np.pi, np.finfo(np.float64).eps)
    return values.mean(axis=0) - np.euler_gamma * scale, scale


def _packed(first: NDArray[np.int64], last: NDArray[np.int64], templates: Sequence[Floats]) -> Floats:
    """Return templates of unequal length as rows of one array, zeros after each."""
    packed = np.zeros((len(templates), int(np.max(last - first, initial=0))))
    for row, template in zip(packed, templates, strict=True):
        row[: len(template)] = template
    return packed


@compiled
def _ratios(e: Floats, templates: Floats, first: NDArray[np.int64], last: NDArray[np.int64], nu: float) -> Floats:
    ratios = np.zeros(len(templates))
    for k in range(len(templates)):
        ratios[k] = _ratio(e[first[k] : last[k]], templates[k, : last[k] - first[k]], nu)[0]
    return ratios


@compiled
def _ratio(e: Floats, s: Floats, nu: float) -> tuple[float, float]:
    """Return the log likelihood ratio of ``e = c s + Student's noise`` against c = 0, and c, by reweighting."""
    c = 0.0
    for step in range(_N_REWEIGHTED):
        product, square = 0.0, 1e-300
        for i in range(len(e)):
            miss = e[i] - c * s[i]
            weight = 1.0 if step == 0 else (nu + 1.0) / (nu + miss * miss)
            product += weight * e[i] * s[i]
            square += weight * s[i] * s[i]
        c = product / square
    ratio = 0.0
    for i in range(len(e)):
        miss = e[i] - c * s[i]
        ratio += np.log((nu + e[i] * e[i]) / (nu + miss * miss))
    return 0.5 * (nu + 1.0) * ratio, c
