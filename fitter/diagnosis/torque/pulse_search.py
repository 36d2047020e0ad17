"""All places for a pulse in one trial at one joint, by their evidence against the background."""

from collections.abc import Iterator

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.least_squares import ITERATIONS, NEGLIGIBLE, SETTLED, TINY
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Rows
from fitter.diagnosis.torque.kalman import Filter, innovations
from fitter.diagnosis.torque.pulse import DURATION_RATIO, FORMS, Pulse, Shapes, either, in_rows, seen, unseen_s
from limbcal.compiled import compiled


class Search:
    """All places for a pulse in one trial at one joint."""

    def __init__(self, trial: int, joint: int, rows: Rows, kalman: Filter, nu: float, size: float) -> None:
        self.trial, self.joint, self.rows, self.kalman, self.nu, self.size = trial, joint, rows, kalman, nu, size
        self.shapes = Shapes.of(rows)
        self.fit = self.shapes.fit(rows)
        #: Evidence at all places that were left when no more was found, (n_shape, n) [nats].
        self.remaining_evidence = np.full(self.fit.shape, -np.inf)

    def evidence(self, e: Floats, places: NDArray[np.bool_]) -> Floats:
        """Return the log evidence for a pulse of each shape that begins with each row, (n_shape, n) [nats].

        It is asked for at some places, (n_shape, n), and nothing at the others.
        """
        k, s = self.kalman, self.shapes
        pulses = s.values, s.before, s.length, places
        return np.asarray(_evidence(e, k.F, k.C, k.gain, k.S, k.known, *pulses, self.nu, self.size))

    def found(self, least: float) -> Iterator[Pulse]:
        """Yield the pulses whose evidence exceeds the least, the most evident first.

        What overlaps one of them is its own form, which is neither a rectangle nor a bell, and no other pulse.
        """
        e = self.kalman.innovations(self.rows.r)
        at_places = self.evidence(e, self.fit)
        while self.fit.any():
            shape, row = np.unravel_index(int(np.argmax(at_places)), at_places.shape)
            evidence = float(np.logaddexp.reduce(at_places, axis=None))
            if evidence < least:
                self.remaining_evidence = at_places
                return
            place = float(self.rows.t[row]) - 0.5 * self.rows.step_s, self.shapes.duration_s[shape]
            pulse = either([self._refined(e, *place, form, evidence) for form in FORMS])
            if self._exceeds_friction(pulse):
                yield pulse
            self.fit &= ~self._overlapping(pulse)
            column = in_rows(self.rows, pulse.start_s, pulse.duration_s, pulse.form)
            change = self.kalman.innovations(pulse.torque_N_m * column)
            e = e - change
            # The filter forgets: far from the pulse nothing has changed.
            anew = self.fit & self.shapes.feel(np.abs(change) > SETTLED)
            at_places = np.where(anew, self.evidence(e, anew), np.where(self.fit, at_places, -np.inf))

    def evidence_by_block(self) -> Floats:
        """Return the evidence in blocks of a longest pulse's length where none was found, (n_block,) [nats]."""
        n = max(1, round(LONGEST_PULSE_S / self.rows.step_s))
        at_rows = np.logaddexp.reduce(self.remaining_evidence, axis=0)
        blocks: Floats = np.logaddexp.reduceat(at_rows, np.arange(0, len(at_rows), n))
        return np.asarray(blocks[np.isfinite(blocks)])

    def _exceeds_friction(self, pulse: Pulse) -> bool:
        """Say whether a pulse during which a joint rests or turns back is larger than friction may differ by."""
        t, step_s = self.rows.t, self.rows.step_s
        last_s = pulse.start_s + pulse.duration_s
        near = (t > pulse.start_s - 1.5 * step_s) & (t < last_s + 1.5 * step_s)
        if np.all((self.rows.known & (self.rows.turning < NEGLIGIBLE))[near]):
            return True
        return abs(pulse.torque_N_m) > 2.0 * float(self.rows.friction.max())

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
        bounds = scipy.optimize.Bounds([-1.0, min(low, 0.0)], [1.0, max(high, 0.0)])
        options = {"initial_simplex": steps, "xatol": NEGLIGIBLE, "fatol": NEGLIGIBLE}

        def loss(place: Floats) -> float:
            return -at(place)[0]

        best = scipy.optimize.minimize(loss, np.zeros(2), method="Nelder-Mead", bounds=bounds, options=options)  # type: ignore[call-overload]
        ratio, size = at(best.x)
        start, lasting = start_s + duration_s * float(best.x[0]), duration_s * float(np.exp(best.x[1]))
        covariance, places = self._errors(start, lasting, form, size)
        before, after = (unseen_s(self.rows, at, way) for at, way in ((start, -1), (start + lasting, 1)))
        covariance[0, 0] += before**2 / 12.0  # uniform where nothing is known
        covariance[1, 1] += (before**2 + after**2) / 12.0
        slope = np.array([0.0, size, lasting])  # of the impulse
        impulse_std = float(np.sqrt(slope @ covariance @ slope))
        start_std, duration_std, torque_std = map(float, np.sqrt(np.diag(covariance)))
        errors = start_std, duration_std, torque_std, impulse_std
        laplace = ratio + places - float(np.log(np.pi * self.size * (1.0 + (size / self.size) ** 2)))
        # Places on the grid and between its points are equally likely beforehand: the mean of both evidences.
        mean = float(np.logaddexp(evidence, laplace) - np.log(2.0))
        found = start, lasting, size, *errors
        return Pulse(self.trial, self.joint, *found, form, ratio, mean, (before, after))

    def _errors(
        self, start_s: float, duration_s: float, form: str, size: float, part: float = 0.05
    ) -> tuple[Floats, float]:
        """Return the covariance of start, duration and size, (3, 3), and the logarithm of the likelihood's volume.

        Both by Fisher's information of Student's location. The volume is in units of the places that are sought,
        times the unit of the size, by Laplace.
        Slopes are taken over a ``part`` of the duration.
        """
        step, rows = part * duration_s, self.rows
        ends = [(s, d) for s in (-step, step) for d in (0.0,)] + [(0.0, -step), (0.0, step)]
        moved = [in_rows(rows, start_s + s, duration_s + d, form) for s, d in ends]
        columns = [
            size * (moved[1] - moved[0]) / (2.0 * step),
            size * (moved[3] - moved[2]) / (2.0 * step),
            in_rows(rows, start_s, duration_s, form),
        ]
        J = np.stack([self.kalman.innovations(column) for column in columns], axis=1)
        information = (self.nu + 1.0) / (self.nu + 3.0) * J.T @ J
        # Where an end is unobserved, it is uniform within the longest duration.
        information += np.diag([12.0 / LONGEST_PULSE_S**2, 12.0 / LONGEST_PULSE_S**2, TINY])
        place = rows.step_s * duration_s * float(np.log(DURATION_RATIO))
        volume = 1.5 * np.log(2.0 * np.pi) - 0.5 * np.linalg.slogdet(information)[1] - np.log(place)
        return np.asarray(np.linalg.inv(information)), float(volume)


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
    for step in range(ITERATIONS):
        before, product, square = c, 0.0, 1e-300
        for i in range(len(e)):
            miss = e[i] - c * s[i]
            weight = 1.0 if step == 0 else (nu + 1.0) / (nu + miss * miss)
            product += weight * e[i] * s[i]
            square += weight * s[i] * s[i]
        c = product / square
        if step > 0 and abs(c - before) < SETTLED * abs(c):
            break
    ratio = 0.0
    for i in range(len(e)):
        miss = e[i] - c * s[i]
        ratio += np.log((nu + e[i] * e[i]) / (nu + miss * miss))
    return 0.5 * (nu + 1.0) * ratio, c, square
