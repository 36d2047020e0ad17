r"""Inequality constraints at rest: what holds a resting joint is no more than its friction can hold.

While a joint is stuck its friction is not known, and its equation is eliminated (`weighting`). But friction is no
larger than it is while the joint moves, and some static friction F that is the same in all rests: so the torque h
that is held, in windows of a rest, and where the joint is torn away, obeys

.. math:: |h| \le f + F \text{ (it rests)}, \qquad |h| \ge f + F \text{ (it is torn away)}

with the friction f of the model, whatever that depends on. The probability of a rest under a torque that the model
misses is nearly 1 inside these limits, and falls like a Gaussian beyond them. So what is beyond counts as a
residual that is one-sided, in units of what the model lacks at any one instant. F >= 0 is the likeliest, joint by
joint: nothing is sought by it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.diagnosis.equations import Equations
from fitter.diagnosis.least_squares import ITERATIONS, SETTLED, Normal
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import Motion
from fitter.diagnosis.regression import Density
from fitter.diagnosis.weighting import Weighting
from fitter.diagnosis.whitening import LASTS_S, RISE_S, inner_rests


@dataclass(frozen=True)
class _Windows:
    """Where a motion's joints rest or are torn away: one limit a row, ``excess = target - design x - static F``.

    Attributes
    ----------
    joint : (n,) int
    at : (n,) int
        The middle sample.
    samples : (n_weighed,) int
        Those that make the rows.
    first, last : (n,) int
        Of these: each row is a mean from the one to before the other…
    way : (n,)
        … with this sign.
    forward : (n,) bool
        Whether it is the limit of friction against a motion forward.
    static : (n,)
        1 where F holds, too; -1 where it is overcome.
    unit : (n,)
        1 over the standard deviation of the row.
    """

    joint: NDArray[np.intp]
    at: NDArray[np.intp]
    samples: NDArray[np.intp]
    first: NDArray[np.intp]
    last: NDArray[np.intp]
    way: Floats
    forward: NDArray[np.bool_]
    static: Floats
    unit: Floats


@dataclass(frozen=True)
class _Limits:
    """Limits under a model, in units of what it lacks: ``excess = target - design x - static F``."""

    joint: NDArray[np.intp]
    design: Floats
    target: Floats
    static: Floats


class FrictionLimits:
    """The rests of some motions.

    Parameters
    ----------
    equations : Equations
        Weighted by what the model lacks.
    motions : sequence of Motion
    part : float
        Which part of the equations' variance is of what the model lacks: so far rests count.
    """

    def __init__(
        self, equations: Equations, motions: Sequence[Motion], part: float, remembered: int = 100
    ) -> None:
        self._remembered = remembered
        self._equations = equations
        self._windows = {one.number: _windows(one, equations.weighting, part) for one in motions}
        self._pushed = {one.number: tuple(_pushed(one, way) for way in (1.0, -1.0)) for one in motions}
        self._known: dict[tuple[object, ...], dict[int, _Limits]] = {}

    def places(self, motion: Motion) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the joint and the middle sample of every row of a motion, (n_row,) each."""
        own = self._windows[motion.number]
        return own.joint, own.at

    def beyond(self, model: Model, x: Floats, motions: Sequence[Motion]) -> list[Floats]:
        """Return by how much limits are exceeded in some motions, in units of what is lacking, (n_row,) each."""
        return self._beyond([self._limits(model, motion) for motion in motions], x)

    def _beyond(self, limits: Sequence[_Limits], x: Floats) -> list[Floats]:
        static = self._static(limits, x)
        return [np.maximum(_excess(one, x, static), 0.0) for one in limits]

    def normal(self, model: Model, x: Floats, motions: Sequence[Motion]) -> Normal:
        """Return the normal equations of those limits that are exceeded under factors x, F eliminated."""
        return self._normal([self._limits(model, motion) for motion in motions], x)

    def _normal(self, limits: Sequence[_Limits], x: Floats) -> Normal:
        static = self._static(limits, x)
        over = [_excess(one, x, static) > 0.0 for one in limits]
        both = list(zip(limits, over, strict=True))
        parts = [np.column_stack([one.design[own], one.target[own]]) for one, own in both]
        holds = [one.static[own] * (static > 0.0)[one.joint[own]] for one, own in both]
        joints = np.concatenate([one.joint[own] for one, own in both])
        rows, hold = np.vstack(parts), np.concatenate(holds)
        for j in range(len(static)):
            own = hold * (joints == j)
            if np.any(own):
                rows = rows - np.outer(own, own @ rows) / float(own @ own)
        gram = rows.T @ rows
        return Normal(gram[:-1, :-1], gram[:-1, -1], float(gram[-1, -1]))

    def likeliest(
        self,
        density: Density,
        normal: Normal,
        numbers: float,
        x: Floats,
        model: Model,
        motions: Sequence[Motion],
        free: NDArray[np.bool_],
    ) -> Floats:
        """Return the likeliest factors if rests have a say: limits that are exceeded are equations, too.

        Parameters
        ----------
        density : Density
        normal : Normal
            The torque equation's.
        numbers : float
            How many independent ones it has.
        x : (n_factor,)
            Where the search begins.
        model : Model
        motions : sequence of Motion
        free : (n_factor,) bool
            Factors that are sought.
        """
        limits, log_density = [self._limits(model, motion) for motion in motions], density.along(model, motions)

        def value(at: Floats) -> float:
            square = normal.sum_of_squares(at) + sum(float(one @ one) for one in self._beyond(limits, at))
            return log_density(at) - 0.5 * numbers * float(np.log(square))

        here = value(x)
        for _ in range(ITERATIONS):
            both = normal.plus(self._normal(limits, x))
            step = density.solve(both.of(free), numbers, x, model, motions) - x
            part, there = 1.0, value(x + step)
            while part > SETTLED and not there > here:
                part *= 0.5
                there = value(x + part * step)
            if not there > here:
                break
            x, gained, here = x + part * step, there - here, there
            if gained < SETTLED:
                break
        return x

    def _static(self, limits: Sequence[_Limits], x: Floats) -> Floats:
        """Return F of every joint [in its own unit], (n_joint,): the likeliest, found by Newton's steps."""
        n_joint = self._equations.arm.n_joint
        found = np.zeros(n_joint)
        joint = np.concatenate([one.joint for one in limits])
        free = np.concatenate([one.target - one.design @ x for one in limits])
        weight = np.concatenate([one.static for one in limits])
        for j in range(n_joint):
            of = joint == j
            own, by = free[of], weight[of]
            for _ in range(ITERATIONS):  # each is exact unless another window gets or loses a say
                active = own - by * found[j] > 0.0
                if not np.any(active):
                    break
                at = max(float(by[active] @ own[active]) / float(by[active] @ by[active]), 0.0)
                if at == found[j]:
                    break
                found[j] = at
        return found

    def _limits(self, model: Model, motion: Motion) -> _Limits:
        # What lies between motor and link turns the link while the motor rests, which is unobservable.
        seen = model.only([one.kind.place != "transmission" for one in model.hypotheses])
        key = tuple((one, psi.tobytes()) for one, psi in zip(seen.hypotheses, seen.psi, strict=True))
        if key not in self._known:
            if len(self._known) >= self._remembered:
                self._known.clear()
            self._known[key] = {}
        known = self._known[key]
        if motion.number not in known:
            known[motion.number] = self._made(seen, motion)
        return known[motion.number]

    def _made(self, model: Model, motion: Motion) -> _Limits:
        own, sides = self._windows[motion.number], []
        for pushed in self._pushed[motion.number]:
            hypothetical = self._equations.hypothetical(model, pushed)
            columns = hypothetical.equations(self._equations.independent(hypothetical.arm), own.samples)
            target = hypothetical.target(self._equations.known, own.samples)
            both = np.concatenate([columns, target[..., None]], axis=2)
            sums = np.concatenate([np.zeros((1, *both.shape[1:])), np.cumsum(both, axis=0)])
            sides.append(sums[own.last, own.joint] - sums[own.first, own.joint])
        weight = own.way * own.unit / (own.last - own.first)
        rows = np.where(own.forward[:, None], *sides) * weight[:, None]
        return _Limits(own.joint, rows[:, :-1], rows[:, -1], own.static * own.unit)


def _excess(limits: _Limits, x: Floats, static: Floats) -> Floats:
    return np.asarray(limits.target - limits.design @ x - limits.static * static[limits.joint], dtype=np.float64)


def _pushed(motion: Motion, way: float) -> Motion:
    """Return a motion whose resting joints are about to move one way."""
    stuck, moves = motion.stuck, (motion.dq, motion.ddq, motion.speed, motion.speed_noise)
    dq, ddq, speed, noise = (np.where(stuck, 0.0, one) for one in moves)
    direction = np.where(stuck, way, motion.direction)
    return replace(motion, dq=dq, ddq=ddq, speed=speed, speed_noise=noise, direction=direction)


def _windows(motion: Motion, weighting: Weighting, part: float) -> _Windows:
    """Return a motion's windows; with a torque that changes quickly the breakaway torque is uncertain."""
    n, n_joint = motion.u.shape
    size = _instant(weighting, motion.dt_s)
    rows: list[tuple[int, int, int, int, float, bool, float, float]] = []
    longest, cut = max(1, round(2.0 * LASTS_S / motion.dt_s)), max(1, round(RISE_S / motion.dt_s))
    for j in range(n_joint):
        for rest in inner_rests(motion.stuck[:, j], motion.dt_s):
            n_part = -(-(rest.stop - rest.start) // longest)
            for samples in np.array_split(np.arange(rest.start, rest.stop), n_part):
                part_of = int(samples[len(samples) // 2]), int(samples[0]), int(samples[-1]) + 1
                rows += [(j, *part_of, way, way > 0.0, 1.0, size[j]) for way in (1.0, -1.0)]
            end = rest.stop + cut
            way = float(motion.direction[end, j]) if end < n else 0.0
            if way:
                changes = 0.5 * float(np.ptp(motion.u[rest.stop - cut : end + cut, j]))
                noise = float(np.hypot(size[j], changes))
                rows.append((j, rest.stop, rest.stop, end, -way, way > 0.0, -1.0, noise))
    joint, at, first, last, ways, forward, static, std = zip(*rows, strict=True) if rows else ((),) * 8
    needed = np.zeros(n, dtype=np.bool_)
    for begin, stop in zip(first, last, strict=True):
        needed[begin:stop] = True
    samples = np.flatnonzero(needed)
    return _Windows(
        np.array(joint, dtype=np.intp),
        np.array(at, dtype=np.intp),
        samples,
        np.searchsorted(samples, np.array(first, dtype=np.intp)),
        np.searchsorted(samples, np.array(last, dtype=np.intp)),
        np.array(ways, dtype=np.float64),
        np.array(forward, dtype=np.bool_),
        np.array(static, dtype=np.float64),
        np.sqrt(part) / np.array(std, dtype=np.float64),
    )


def _instant(weighting: Weighting, dt_s: float) -> Floats:
    """Return the standard deviation of the noise of every joint's equation at any one instant, (n_joint,)."""
    power = np.mean([np.diag(weighting.covariance(at)) for at in weighting.frequencies], axis=0)
    return np.asarray(np.sqrt(power * min(weighting.n_in_band(1, dt_s) / weighting.stride, 1.0)), dtype=np.float64)
