"""Disturbance pulses: their times are part of the finding, as those of loads are (`payload`).

They are sought over the whole run, learning and evaluating trials alike, for a trial that was not affected says
nothing of them, and one that was cannot be predicted from others.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_opening

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind
from arm.model import Floats, JointType
from fitter.data.derivatives import lowpass
from fitter.diagnosis.evidence import blocks_of
from fitter.diagnosis.holding_torque import friction_at_rest
from fitter.diagnosis.least_squares import ITERATIONS, NEGLIGIBLE, ODDS_NATS, TINY, Normal
from fitter.diagnosis.model import Candidate, Hypothesis
from fitter.diagnosis.motion import HypotheticalMotion, Motion
from fitter.diagnosis.refinement import fitted
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.torque.pulse import Pulse, pulse_means
from fitter.diagnosis.torque.pulses import find_pulses, residual_log_evidence
from fitter.diagnosis.torque.residual_torque import ResidualTorque

_NUMBERS = ("start_s", "duration_s", "torque_N_m")


class DisturbancePulses(Hypothesis):
    """Some pushes at one joint.

    Parameters
    ----------
    kind : EffectKind
    joint : int
    found : sequence of Pulse
        On the run's clock. They are known torques: their size is what the search found beside the coloured
        background, which a fit of white residuals does not know.
    """

    is_event = True
    is_inertial = False
    is_intermittent = True
    is_noisy = False

    def __init__(self, kind: EffectKind, joint: int, found: Sequence[Pulse]) -> None:
        super().__init__(kind, (joint,))
        self.found = tuple(found)

    @property
    def n_number(self) -> int:
        """Start, duration and torque of each."""
        return len(_NUMBERS) * len(self.found)

    def act(self, hypothetical: HypotheticalMotion, psi: Floats) -> HypotheticalMotion:
        """Return a motion that the pushes drove, too."""
        u, motion = hypothetical.u.copy(), hypothetical.motion
        for one in self.found:
            shape = pulse_means(motion.t, motion.dt_s, one.start_s, one.duration_s, one.form)
            u[:, self.joints[0]] += one.torque_N_m * shape
        return replace(hypothetical, u=u)

    def numbers(self, psi: Floats, factors: Floats) -> Floats:
        """Return start, duration and torque of each push."""
        return np.ravel([[getattr(one, name) for name in _NUMBERS] for one in self.found])

    def hidden(self, motions: Sequence[Motion], values: Floats) -> Floats:
        """Return the standard errors with which the pushes were found: the fit has no number of theirs."""
        return np.ravel([[one.start_std, one.duration_std, one.torque_std] for one in self.found])

    @property
    def names(self) -> tuple[str, ...]:
        """Numbered where there are several pushes."""
        names = [parameter.name for parameter in self.kind.numbers]
        if len(self.found) == 1:
            return tuple(names)
        return tuple(f"{name}_{k + 1}" for k in range(len(self.found)) for name in names)

    def units_at(self, joint: JointType) -> tuple[str, ...]:
        """Return those of each, at joints of a type."""
        return super().units_at(joint) * len(self.found)


def robustly_fitted(regression: Regression, candidate: Candidate) -> Candidate:
    r"""Return a model with factors fitted robustly to all trials, its psi as they are.

    The residual of a joint in a block of a second follows Student's distribution of n dimensions, so a block
    counts ``u = (nu + n) / (nu + chi^2 / s^2)`` with ``s^2 = sum u chi^2 / sum n``, in turn with the factors
    (Lange, Little and Taylor 1989). What moves an arm for a moment has little say then.

    Parameters
    ----------
    regression : Regression
    candidate : Candidate
        Fitted by least squares.
    """
    model, x = candidate.model, candidate.x
    if regression.density is None or not len(x):
        return candidate
    motions = regression.motions
    rows = [regression.rows(model, motion) for motion in motions]
    designs = [one.design.reshape(*one.target.shape, -1) for one in rows]
    stride = regression.weighting.stride
    blocks = [blocks_of(len(one.target), stride * motion.dt_s) for motion, one in zip(motions, rows, strict=True)]
    counts = [np.bincount(block).astype(np.float64)[:, None] for block in blocks]
    numbers, total = float(regression.n_effective.sum()), sum(one.target.size for one in rows)
    variance = np.inf
    for _ in range(ITERATIONS):
        squares = [_in_blocks(one.residual(x) ** 2, block) for one, block in zip(rows, blocks, strict=True)]
        weights = [_weights(square, count, variance) for square, count in zip(squares, counts, strict=True)]
        was, summed = variance, sum(float(np.sum(u * square)) for u, square in zip(weights, squares, strict=True))
        variance = max(summed / total, TINY)
        if abs(was - variance) < NEGLIGIBLE * variance:
            break
        parts = zip(designs, (one.target for one in rows), weights, blocks, strict=True)
        normal = _normal([(design, target, u[block]) for design, target, u, block in parts])
        counted = sum(float(np.sum(u * count)) for u, count in zip(weights, counts, strict=True))
        x = regression.density.solve(normal, numbers * counted / total, x, model, motions)
    return replace(candidate, x=x, squares=regression.squares(model, x))


def _in_blocks(squares: Floats, block: NDArray[np.intp]) -> Floats:
    """Return the sums of rows (n, n_joint) over blocks, (n_block, n_joint)."""
    sums = np.zeros((int(block[-1]) + 1, squares.shape[1]))
    np.add.at(sums, block, squares)
    return sums


def _weights(squares: Floats, counts: Floats, variance: float, freedom: float = 4.0) -> Floats:
    """Return how much each block of each joint counts by Student's likelihood, (n_block, n_joint).

    With 4 degrees of freedom it hardly loses anything to a normal one, and is not misled (Lange et al. 1989).
    """
    if not np.isfinite(variance):
        return np.ones_like(squares)
    return np.asarray((freedom + counts) / (freedom + squares / variance))


def _normal(parts: list[tuple[Floats, Floats, Floats]]) -> Normal:
    """Return the normal equations of weighted rows: of design, target and weights of each motion."""
    gram = sum(np.einsum("rji,rj,rjk->ik", design, u, design, optimize=True) for design, _, u in parts)
    rhs = sum(np.einsum("rji,rj->i", design, u * target) for design, target, u in parts)
    square = sum(float(np.sum(u * target**2)) for _, target, u in parts)
    return Normal(np.asarray(gram), np.asarray(rhs), square)


def with_pulses(
    regression: Regression, final: Candidate, possible: Callable[[], Sequence[tuple[Candidate, float]]] = tuple
) -> Candidate:
    """Return a model with the pushes that are found in what it misses; the same if there is none.

    The residual of a cause that was just too weak to be accepted is no push: a push is also likelier than not
    given each model that is not excluded, unless all pushes together are a hundred times likelier than that model.

    Parameters
    ----------
    regression : Regression
    final : Candidate
        With all causes that always act.
    possible : callable, optional
        Returns models with one cause more that are not excluded, and what that cause costs [nats].
    """
    found = _found(regression, final, ODDS_NATS)
    for other, cost in possible() if found else ():
        likely = _found(regression, other, 0.0)
        kept = [one for one in found if any(map(one.overlaps, likely))]
        if len(kept) < len(found) and cost + _gain(regression, (final, found), (other, likely)) < ODDS_NATS:
            found = kept
        if not found:
            break
    return fitted_with_pulses(regression, final, found)


def _found(regression: Regression, final: Candidate, least: float) -> list[Pulse]:
    """Return the pushes in what a model misses whose log odds are large enough, the model fitted with them."""
    candidate, known = robustly_fitted(regression, final), list[list[tuple[int, int]]]()
    while True:  # pushes bend the parameters of the model that they are sought in
        found = find_pulses(residual_torques(regression, _without_pulses(final, candidate)), least)
        candidate = fitted_with_pulses(regression, final, found)
        places = [(one.trial, one.joint) for one in found]
        if not places or places in known:
            return found
        known.append(places)


def _gain(
    regression: Regression, one: tuple[Candidate, list[Pulse]], other: tuple[Candidate, list[Pulse]]
) -> float:
    """Return by how much the residual of a model with pushes is likelier than another's, where both are known."""
    residuals = []
    for model, found in (one, other):
        candidate = robustly_fitted(regression, fitted_with_pulses(regression, model, found))
        residuals.append(residual_torques(regression, _without_pulses(model, candidate)))
    known = [a.known & b.known for a, b in zip(*residuals, strict=True)]
    shared = [
        [replace(trial, known=where) for trial, where in zip(trials, known, strict=True)] for trials in residuals
    ]
    return residual_log_evidence(shared[0], one[1]) - residual_log_evidence(shared[1], other[1])


def _without_pulses(final: Candidate, candidate: Candidate) -> Candidate:
    """Return a model that was fitted with pushes without them, its other numbers as they are."""
    n_hypothesis = len(final.model.hypotheses)
    return replace(
        candidate, model=candidate.model.only([k < n_hypothesis for k in range(len(candidate.model.hypotheses))])
    )


def fitted_with_pulses(regression: Regression, final: Candidate, found: Sequence[Pulse]) -> Candidate:
    """Return a model with some pulses, fitted together with them; the same if there is none."""
    model, kind = final.model, catalogue()["external_push"]
    for joint in sorted({one.joint for one in found}):
        model = model.plus(
            DisturbancePulses(kind, joint, [one for one in found if one.joint == joint]), np.zeros(0)
        )
    return fitted(regression, model, refine=False) if found else final


def residual_torques(regression: Regression, final: Candidate) -> list[ResidualTorque]:
    """Return what a model misses in every trial, within the band of its equations: a push has its own sign.

    Of a joint that rests for longer than the filter's reach nothing is known. Where it only turns back, all but
    its friction is.
    """
    own = regression.sensors
    angle_noise = np.sqrt(np.diag(own.acceleration_noise))
    trials = []
    for motion in regression.motions:
        residual = regression.equations.residual_torque(final.model, final.x, motion)
        r, torque = (lowpass(column, motion.dt_s, own.band_hz, "even") for column in (-residual, motion.u))
        reach = round(0.5 / (own.band_hz * motion.dt_s))  # so far the filter looks: half a period of its corner
        near = np.ones((2 * reach + 1, 1), dtype=np.bool_)
        guessed = regression.hypothetical(final.model, motion).guessed[:, None]
        rests = binary_opening(motion.stuck, near)
        known = ~binary_dilation(rests | guessed, near, border_value=1)
        stuck = lowpass(motion.stuck.astype(np.float64), motion.dt_s, own.band_hz, "even")
        friction = friction_at_rest(regression.equations, final.model, final.x, motion)
        noises = own.band_hz, own.torque_noise, angle_noise
        trials.append(ResidualTorque(motion.t, r, known, torque, *noises, friction, np.clip(stuck, 0.0, 1.0)))
    return trials
