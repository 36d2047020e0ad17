"""A pulse, a torque of some duration, as the rows of a residual see it; and all shapes that are sought."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Rows
from fitter.diagnosis.torque.pulse_column import FORMS, in_rows, seen

#: Rows of the shortest pulse that has a duration: a period of the band's corner.
SHORTEST_ROWS = 2
#: Ratio of durations sought: two an octave, neighbours correlated by 0.84.
DURATION_RATIO = np.sqrt(2.0)


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
    impulse_std : float [N m s]
        That of torque times duration.
    form : str
        ``rectangular``, or ``bell``: a raised cosine.
    log_likelihood_ratio, evidence : float [nats]
        Under the background in which it was found: at its likeliest, and integrated over the prior of its size and
        summed over all places in its trial.
    unseen_s : (float, float) [s]
        For how long nothing is known about its start and its end: they lie somewhere there. 0 where they are seen.
    """

    trial: int
    joint: int
    start_s: float
    duration_s: float
    torque_N_m: float
    start_std: float
    duration_std: float
    torque_std: float
    impulse_std: float
    form: str
    log_likelihood_ratio: float
    evidence: float
    unseen_s: tuple[float, float] = (0.0, 0.0)

    @property
    def impulse(self) -> float:
        """Torque times duration, the area of either form [N m s]."""
        return self.torque_N_m * self.duration_s

    @property
    def sigmas(self) -> float:
        """How many standard errors its size is off zero: its torque, or its impulse if that is known better.

        Of a pulse too short for the band the impulse is known, of one whose end is unseen the torque.
        """
        return max(abs(self.torque_N_m) / self.torque_std, abs(self.impulse) / self.impulse_std)

    def overlaps(self, other: "Pulse") -> bool:
        """Say whether another pulse pushes the same joint at the same time the same way."""
        begin, end = max(self.start_s, other.start_s), min(self.ends_s, other.ends_s)
        same = (self.trial, self.joint) == (other.trial, other.joint)
        return same and begin < end and self.torque_N_m * other.torque_N_m > 0.0

    @property
    def ends_s(self) -> float:
        """When it ends [s]."""
        return self.start_s + self.duration_s


def are_same(some: Sequence[Pulse], others: Sequence[Pulse]) -> bool:
    """Say whether two searches have found the same pulses: as many, and each overlaps one of the other."""
    return len(some) == len(others) and all(any(map(one.overlaps, others)) for one in some)


def without(rows: Sequence[Rows], pulses: Sequence[Pulse]) -> list[Rows]:
    """Return the residuals of the trials without some pulses."""
    remaining = [replace(part, r=part.r.copy()) for part in rows]
    for pulse in pulses:
        part = remaining[pulse.trial]
        place = pulse.start_s, pulse.duration_s, pulse.form
        part.r[:] -= pulse.torque_N_m * in_rows(part, *place)
    return remaining


def either(forms: Sequence[Pulse]) -> Pulse:
    """Return the likelier of one pulse's forms; its errors hold the other one, as likely as that is."""
    one = max(forms, key=lambda form: form.log_likelihood_ratio)
    weight = np.exp([form.log_likelihood_ratio - one.log_likelihood_ratio for form in forms])

    def apart(of: Callable[[Pulse], float]) -> float:
        return float(np.sqrt(np.average([(of(form) - of(one)) ** 2 for form in forms], weights=weight)))

    start, lasting, torque = (
        apart(of) for of in (lambda form: form.start_s, lambda form: form.duration_s, lambda form: form.torque_N_m)
    )
    return replace(
        one,
        start_std=float(np.hypot(one.start_std, start)),
        duration_std=float(np.hypot(one.duration_std, lasting)),
        torque_std=float(np.hypot(one.torque_std, torque)),
        impulse_std=float(np.hypot(one.impulse_std, apart(lambda form: form.impulse))),
    )


class Shapes:
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
        pairs = [(float(duration_s), form) for duration_s in durations(step_s) for form in FORMS]
        self.duration_s, self.form = [list(part) for part in zip(*pairs, strict=True)]
        self.lasting = np.array([round(duration_s / step_s) for duration_s, _ in pairs])
        n = int(np.ceil((3.0 * LONGEST_PULSE_S + 2.0 / band_hz) / step_s))  # either side: no end cuts a pulse
        t = step_s * np.arange(-n, n + 1, dtype=np.float64)
        known, noises, friction, turning, reversing = (
            np.ones(len(t), dtype=np.bool_),
            (0.0, 0.0),
            *np.zeros((3, len(t))),
        )
        rows = Rows(
            t, 0.0 * t, known, t[:, None], n_sample, band_hz, *noises, friction, turning, reversing, ~known
        )
        parts = [seen(rows, -0.5 * step_s, *pair, reach_s=1.0 / band_hz) for pair in pairs]
        self.before = np.array([n - first for first, _ in parts])
        self.length = np.array([len(part) for _, part in parts])
        self.values = np.zeros((len(pairs), int(self.length.max())))
        for row, (_, part) in zip(self.values, parts, strict=True):
            row[: len(part)] = part

    @classmethod
    def of(cls, rows: Rows, digits: int = 9) -> "Shapes":
        """Return the shapes of some rows: made once for all of the same step."""
        return _shapes(round(rows.step_s, digits), rows.n_sample, rows.band_hz)

    def fit(self, rows: Rows) -> NDArray[np.bool_]:
        """Say with which rows a pulse may begin, (n_shape, n): where half of what it lasts is known.

        It may begin or end unseen: a push that stops a joint, or moves one that rests, does.
        """
        n = len(rows.t)
        known = np.concatenate([[0], np.cumsum(rows.known)])
        begin = np.arange(n)
        end = begin + self.lasting[:, None]
        seen = known[np.minimum(end, n)] - known[begin]
        return np.asarray((end < n) & (2 * seen >= self.lasting[:, None]), dtype=np.bool_)

    def feel(self, where: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Say which pulses are felt in some of the rows (n,), by the row with which they begin, (n_shape, n)."""
        n = len(where)
        count = np.concatenate([[0], np.cumsum(where)])
        first = np.arange(n) - self.before[:, None]
        last = first + self.length[:, None]
        return np.asarray(count[np.clip(last, 0, n)] > count[np.clip(first, 0, n)])


@cache
def _shapes(step_s: float, n_sample: int, band_hz: float) -> Shapes:
    return Shapes(step_s, n_sample, band_hz)


def durations(step_s: float) -> Floats:
    """Return the durations that are sought [s]: from a period of the band's corner to the longest.

    What is shorter has no duration in this band.
    """
    shortest_s = SHORTEST_ROWS * step_s
    n = 1 + max(0, int(np.log(LONGEST_PULSE_S / shortest_s) / np.log(DURATION_RATIO)))
    return np.asarray(shortest_s * DURATION_RATIO ** np.arange(n))
