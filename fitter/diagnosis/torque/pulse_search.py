"""All places for a pulse in one trial at one joint, by their evidence against the background."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.least_squares import NEGLIGIBLE, SETTLED, TINY
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Background, Rows
from fitter.diagnosis.torque.kalman import Filter, innovations
from fitter.diagnosis.torque.pulse import SHORTEST_ROWS, Pulse, Shapes, either
from fitter.diagnosis.torque.pulse_column import FORMS, in_rows
from fitter.diagnosis.torque.pulse_errors import place_errors
from fitter.diagnosis.torque.pulse_place import likeliest_place
from fitter.diagnosis.torque.rests import amid, filtered_with_rests, with_rests
from fitter.diagnosis.torque.student_ratio import likeliest_ratio, likeliest_size, log_loss, log_ratio
from limbcal.compiled import compiled


class Search:
    """All places for a pulse in one trial at one joint."""

    def __init__(self, trial: int, joint: int, rows: Rows, background: Background, size: float) -> None:
        self.trial, self.joint, self.rows, self.background, self.size = trial, joint, rows, background, size
        self.kalman, self.nu = background.filtered(rows), background.degrees_of_freedom
        self.shapes = Shapes.of(rows)
        self.fit = self.shapes.fit(rows)
        #: Evidence at all places that were left when no more was found, (n_shape, n) [nats].
        self.remaining_evidence = np.full(self.fit.shape, -np.inf)

    @cached_property
    def _with_rests(self) -> tuple[Rows, Filter]:
        return with_rests(self.rows), filtered_with_rests(self.background, self.rows)

    def evidence(self, r: Floats, places: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """Return the log evidence for a pulse of each shape that begins with each row, and what is attainable.

        Both are asked for at some places, (n_shape, n), and there is nothing at the others. A pulse makes no row
        an outlier; before it, and where there is none, rows have the weights of the residual. Of a large pulse
        much is attainable where its place is not exact, and nothing evident: the lesser of what it would be under
        normal noise, and of a perfect fit of its rows.

        Returns
        -------
        evidence, attainable : (n_shape, n) [nats]
        """
        k, weighted, s = self.kalman, self.kalman.weighted(r, self.nu), self.shapes
        e, states = weighted.innovations(r), weighted.predicted(r)
        pulses = s.values, s.before, s.length, places
        both = _evidence(r, e, states, k.F, k.C, k.gain, k.S, k.known, *pulses, self.nu, self.size)
        return np.asarray(both[0]), np.asarray(both[1])

    def found(self, least: float) -> Iterator[Pulse]:
        """Yield the pulses whose evidence exceeds the least, the most evident first.

        What overlaps one of them is its own form, which is neither a rectangle nor a bell, and no other pulse.
        """
        r = self.rows.r
        at_places, attainable = self.evidence(r, self.fit)
        while self.fit.any():
            evidence = float(np.logaddexp.reduce(at_places, axis=None))
            likely = (evidence, at_places), (float(attainable.max()), attainable)
            begun = {self._place(of) for nats, of in likely if nats >= least}
            found = [self.near(place, evidence, r) for place in begun]
            pulse = max(found, key=lambda one: one.evidence, default=None)
            if pulse is None or max(evidence, pulse.evidence) < least:
                self.remaining_evidence = at_places
                return
            if pulse.evidence >= least and self._exceeds_friction(pulse):
                yield pulse
            self.fit &= ~self._overlapping(pulse)
            before = self._innovations(r)
            r = r - pulse.torque_N_m * in_rows(self.rows, pulse.start_s, pulse.duration_s, pulse.form)
            # The filter forgets: far from the pulse nothing has changed.
            anew = self.fit & self.shapes.feel(np.abs(self._innovations(r) - before) > SETTLED)
            both = zip(self.evidence(r, anew), (at_places, attainable), strict=True)
            at_places, attainable = (np.where(anew, one, np.where(self.fit, was, -np.inf)) for one, was in both)

    def _place(self, of: Floats) -> tuple[float, float]:
        """Return start and duration of the pulse that has most of something, (n_shape, n)."""
        shape, row = np.unravel_index(int(np.argmax(of)), of.shape)
        return float(self.rows.t[row]) - 0.5 * self.rows.step_s, float(self.shapes.duration_s[shape])

    def near(self, place: tuple[float, float], evidence: float, r: Floats | None = None) -> Pulse:
        """Return the likeliest pulse near a start and a duration [s], of either form, in a residual (n,)."""
        rows = self.rows.r if r is None else r
        return either([self._refined(rows, *place, form, evidence) for form in FORMS])

    def again(self, pulse: Pulse) -> Pulse:
        """Return the likeliest pulse near another one, with the evidence of all places that overlap that one."""
        at_places, _ = self.evidence(self.rows.r, self.fit & self._overlapping(pulse))
        evidence = float(np.logaddexp.reduce(at_places, axis=None))
        return self.near((pulse.start_s, pulse.duration_s), evidence)

    def _innovations(self, r: Floats) -> Floats:
        return self.kalman.weighted(r, self.nu).innovations(r)

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

    def _refined(self, r: Floats, start_s: float, duration_s: float, form: str, evidence: float) -> Pulse:
        """Return a pulse at its likeliest start and duration, with standard errors from Fisher's information.

        Rows have the weights that they have without the pulse. What no friction holds acts in a rest, too, if at
        all: its rows tell.
        """
        rows, own = self.rows, self.kalman
        kalman = own
        for _ in range(2):
            start_s, duration_s, size = likeliest_place(rows, kalman, self.nu, r, (start_s, duration_s), form)
            if abs(size) > 2.0 * float(rows.friction.max()):
                rows, own = self._with_rests
            start_s, duration_s, before, after = amid(rows, start_s, duration_s)
            column = in_rows(rows, start_s, duration_s, form)
            remaining = r - likeliest_ratio(kalman.innovations(r), kalman.innovations(column), self.nu)[1] * column
            kalman = own.weighted(remaining, self.nu)
            size = likeliest_ratio(kalman.innovations(r), kalman.innovations(column), self.nu)[1]
        remaining = r - size * column
        ratio = log_ratio(kalman.innovations(remaining), own.weighted(r, self.nu).innovations(r), self.nu)
        place = start_s, duration_s, form
        covariance, places = place_errors(rows, kalman, self.nu, place, size, (before, after))
        slope = np.array([0.0, size, duration_s])  # of the impulse
        impulse_std = float(np.sqrt(slope @ covariance @ slope))
        start_std, duration_std, torque_std = map(float, np.sqrt(np.diag(covariance)))
        if not (before or after) and duration_s - duration_std < SHORTEST_ROWS * self.rows.step_s:
            # Anything shorter of the same impulse looks alike: the duration is uniform from 0 to there.
            duration_std, torque_std = max(duration_std, duration_s / 3.0**0.5), max(torque_std, abs(size))
        errors = start_std, duration_std, torque_std, impulse_std
        laplace = ratio + places - float(np.log(np.pi * self.size * (1.0 + (size / self.size) ** 2)))
        # Places on the grid and between its points are equally likely beforehand: the mean of both evidences.
        mean = float(np.logaddexp(evidence, laplace) - np.log(2.0))
        found = start_s, duration_s, size, *errors
        return Pulse(self.trial, self.joint, *found, form, ratio, mean, (before, after))


@compiled
def _evidence(
    r: Floats,
    e: Floats,
    states: Floats,
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
) -> tuple[Floats, Floats]:
    """Return the log evidence of each shape at each row, with Cauchy's prior of a pulse's size, eq. (m.2).

    With it comes what is attainable of each.

    Parameters
    ----------
    r, e : (n,)
        Residual, and its innovations without any pulse.
    states : (n, d)
        Expected before each row.
    """
    n_shape, n = fit.shape
    evidence, attainable = np.full((n_shape, n), -np.inf), np.full((n_shape, n), -np.inf)
    perfect = np.concatenate((np.zeros(1), np.cumsum(0.5 * (nu + 1.0) * np.log1p(e**2 / nu))))
    longest, nothing = int(length.max()), np.zeros(len(F))
    template, own = np.zeros(longest), np.zeros(longest)
    for felt in range(-int(before.max()), n):  # all shapes that are felt from the same row on
        first, end = max(0, felt), max(0, min(n, felt + longest))
        innovations(F, C, gain, S, known, r[first:end], first, states[first], own[: end - first])
        for i in range(n_shape):
            k, last = felt + before[i], min(n, felt + length[i])
            if not (0 <= k < n and first < last and fit[i, k]):
                continue
            s, beside = template[: last - first], own[: last - first]
            column = shapes[i, first - felt : last - felt]
            innovations(F, C, gain, S, known, column, first, nothing, s)
            c, information = likeliest_size(beside, s, nu)
            ratio = perfect[last] - perfect[first] - log_loss(beside, s, c, nu)
            width = 0.5 * np.log(2.0 * np.pi / information)  # of the likelihood, by Laplace
            prior = width - np.log(np.pi * size * (1.0 + (c / size) ** 2))
            evidence[i, k] = ratio + prior
            normal = 0.5 * np.dot(s, beside) ** 2 / max(np.dot(s, s), TINY)
            attainable[i, k] = min(normal, perfect[last] - perfect[first]) + prior
    return evidence, attainable
