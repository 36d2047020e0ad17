"""A reference that reveals an arm's base parameters, found trial by trial by the genetic algorithm.

Each trial is chosen to complete those before it. The cost is ``log max e + mean log e + log k``. e are the
predicted standard errors of the wanted parameters in units of their sizes, so the worst of them counts, and all
besides; k is the condition number of the regressor with its columns scaled to length one, left out where only some
parameters are wanted. References that exceed a limit are made smaller; where that is not enough they cost more
than any other, and the more the further they do.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from arm.base_parameters import BaseParameters
from arm.bench import Bench, motions
from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from arm.simulation import Motion
from arm.structural_parameters import structural_parameters
from fitter.excitation.driven import Limits, driven, finely_driven, furthest, reached, rest_at, search_step_s
from fitter.excitation.information import NOISE, Precision, information, precision_of
from fitter.excitation.shapes import Fourier, Points, Shape
from fitter.search.genetic import GeneticAlgorithm
from limbcal.errors import ConfigError, NotConverged

Kind = Literal["fourier", "points"]

POPULATION, GENERATIONS = 40, 30
#: A search keeps this far from the limits, because its steps are coarse.
_SAFE = 0.01
#: Steps a second of the random motions' simulation.
_SIMULATION_HZ = 1000.0
#: Random motions that show how far the arm usually goes: as many as the bench has.
_USUAL = Bench().trials
#: Random motion may be at its furthest where the arm just hangs; there must be room on both sides of that.
_BEYOND = 1.1
#: How often a reference that exceeds a limit is made smaller as a whole.
_EASINGS = 4
#: What a reference costs that exceeds a limit, beside a hundred times its excess.
_FORBIDDEN = 1e3
#: Errors and condition numbers larger than this are as good as infinite.
_NEVER = 1e12


@dataclass(frozen=True)
class Suggestion:
    """References and what they are predicted to tell.

    Attributes
    ----------
    motions : tuple of Motion
        Trial by trial, as the arm file predicts them; ``ref`` is what to ask for.
    base : BaseParameters
    values : (n_base,)
        Of the arm file.
    suggested, random : Precision
        Of these motions, and of the bench's random ones of the same length.
    limits, reached : Limits
    noise : (n_joint,)
        The torque's, per sample, that errors are predicted for.
    """

    motions: tuple[Motion, ...]
    base: BaseParameters
    values: Floats
    suggested: Precision
    random: Precision
    limits: Limits
    reached: Limits
    noise: Floats


def suggest(
    arm: Arm,
    kind: Kind,
    bench: Bench,
    *,
    seed: int,
    angle: Floats | None = None,
    speed: Floats | None = None,
    torque: Floats | None = None,
    reveal: Sequence[str] = (),
    population: int = POPULATION,
    generations: int = GENERATIONS,
    progress: Callable[[], None] | None = None,
) -> Suggestion:
    """Find a reference that reveals base parameters.

    Parameters
    ----------
    arm : Arm
        Its law drives it; with measured torque the reference is the motion.
    kind : {"fourier", "points"}
    bench : Bench
        ``learning`` trials of ``trial_s`` at ``rate_hz``; random motion is drawn from ``span_rad``.
    seed : int
    angle, speed, torque : (n_joint,), optional
        Limits. By default what the bench's 22 random motions reach; of angles a tenth beyond that, at least
        ``span_rad``.
    reveal : sequence of str
        Names of base parameters; all by default.
    population, generations : int
        Of the search for each trial.
    progress : callable, optional
        Called after every generation.

    Raises
    ------
    ConfigError
        If a name is not that of a base parameter, or the arm cannot be simulated.
    NotConverged
        If no reference within the limits was found.
    """
    base = structural_parameters(arm)
    unknown = sorted(set(reveal) - set(base.names))
    if unknown:
        raise ConfigError(
            f"no base parameter is called {', '.join(unknown)}; this arm has {', '.join(base.names)}"
        )
    if bench.trial_s <= 2.0 * bench.rest_s:
        raise ConfigError(
            f"a trial of {bench.trial_s:g} s has no time to move: {bench.rest_s:g} s rest at each end"
        )
    step_s = search_step_s(arm)
    drawn = _random_motions(arm, replace(bench, learning=max(bench.learning, _USUAL)), seed)
    random = drawn[: bench.learning]
    noise = np.maximum(NOISE * np.sqrt(np.mean(np.concatenate([m.tau for m in random]) ** 2, axis=0)), 1e-12)
    usual = furthest([reached(m) for m in drawn])
    limits = Limits(
        np.maximum(_BEYOND * usual.angle, bench.span_rad) if angle is None else angle,
        usual.speed if speed is None else speed,
        usual.torque if torque is None else torque,
    )
    values = base.combination @ standard_parameters(arm)
    known = _gram(arm, base, random, noise)
    search = _Search(
        arm,
        base,
        _shape(kind, arm, bench, (1.0 - 2.0 * _SAFE) * limits.angle),
        replace(bench, rate_hz=1.0 / step_s),
        limits,
        noise,
        _sizes(values, known, bench),
        np.array([name in reveal or not reveal for name in base.names]),
        bench.rate_hz * step_s,
    )
    found, ends = [], np.zeros(arm.n_joint)
    gram = np.zeros((len(base.names), len(base.names)))
    rng = np.random.default_rng([seed, 4])
    for _ in range(bench.learning):
        start = rest_at(arm, ends)
        genes = search.best(gram, ends, start, rng, population, generations, progress)
        reference = search.shape.trial(genes, _times(bench), ends)
        motion = finely_driven(arm, reference, 1.0 / bench.rate_hz, start)
        gram += _gram(arm, base, [motion], noise)
        found.append(motion)
        ends = motion.ref[-1]
    far = furthest([reached(m) for m in found])
    if not limits.excess(far) <= 0.0:
        raise NotConverged(_too_far(limits, far))
    return Suggestion(tuple(found), base, values, precision_of(gram), precision_of(known), limits, far, noise)


@dataclass(frozen=True)
class _Search:
    """The search for one trial after the other."""

    arm: Arm
    base: BaseParameters
    shape: Shape
    bench: Bench
    limits: Limits
    noise: Floats
    size: Floats
    wanted: Floats
    samples: float  # at the rate that is asked for, in the time of one step of the search

    def best(
        self,
        gram: Floats,
        before: Floats,
        start: Floats,
        rng: np.random.Generator,
        population: int,
        generations: int,
        progress: Callable[[], None] | None,
    ) -> Floats:
        """Return the genes of the trial that completes what is known best, (n_gene,)."""
        one = np.ones(self.shape.n_gene)
        algorithm = GeneticAlgorithm(-one, one, rng, max(population, 2 * len(one)))
        for _ in range(generations):
            costs = np.array([self._cost(genes, gram, before, start) for genes in algorithm.ask()])
            algorithm.tell(costs)
            if progress is not None:
                progress()
        return self._eased(algorithm.best, before, start)[0]

    def _eased(self, genes: Floats, before: Floats, start: Floats) -> tuple[Floats, Motion, float]:
        """Return genes made smaller, all alike, until no limit is exceeded; their motion, and the excess left."""
        for easing in range(_EASINGS + 1):
            reference = self.shape.trial(genes, _times(self.bench), before)
            motion = driven(self.arm, reference, 1.0 / self.bench.rate_hz, start)
            excess = self.limits.excess(reached(motion)) + _SAFE if np.isfinite(motion.q).all() else np.inf
            if excess <= 0.0 or easing == _EASINGS:
                break
            genes = genes * max(1.0 / (1.0 + excess) - _SAFE, 0.1)
        return genes, motion, excess

    def _cost(self, genes: Floats, gram: Floats, before: Floats, start: Floats) -> float:
        motion, excess = self._eased(genes, before, start)[1:]
        if not excess <= 0.0:
            return _FORBIDDEN + 100.0 * excess
        both = precision_of(gram + self.samples * information(self.arm, self.base, motion, self.noise))
        errors = np.log(np.minimum(both.std / self.size, _NEVER))[self.wanted]
        alike = np.log(min(both.condition_number, _NEVER)) if self.wanted.all() else 0.0
        return float(errors.max() + errors.mean() + alike)


def _shape(kind: Kind, arm: Arm, bench: Bench, span: Floats) -> Shape:
    if kind == "points":
        return Points(bench.trial_s, bench.rest_s, span, arm.control.law == "measured")
    return Fourier(bench.trial_s, bench.rest_s, span)


def _times(bench: Bench) -> Floats:
    return np.arange(round(bench.trial_s * bench.rate_hz), dtype=np.float64) / bench.rate_hz


def _gram(arm: Arm, base: BaseParameters, moved: Sequence[Motion], noise: Floats) -> Floats:
    return np.asarray(sum(information(arm, base, motion, noise) for motion in moved), dtype=np.float64)


def _random_motions(arm: Arm, bench: Bench, seed: int) -> list[Motion]:
    """Return the bench's motions; with measured torque, random points that are gone to smoothly."""
    if arm.control.law != "measured":
        return list(motions(arm, replace(bench, evaluating=0, simulation_hz=_SIMULATION_HZ), seed))
    shape = Points(bench.trial_s, bench.rest_s, np.full(arm.n_joint, bench.span_rad), smooth=True)
    rng, ends, moved = np.random.default_rng([seed, 1]), np.zeros(arm.n_joint), []
    for _ in range(bench.learning):
        reference = shape.trial(rng.uniform(-1.0, 1.0, shape.n_gene), _times(bench), ends)
        moved.append(driven(arm, reference, 1.0 / bench.rate_hz, ends))
        ends = reference[0, -1]
    return moved


def _sizes(values: Floats, gram: Floats, bench: Bench) -> Floats:
    """Return what errors are compared with: a parameter's value, or what makes as much torque as noise does."""
    samples = bench.learning * bench.trial_s * bench.rate_hz
    felt = np.diag(gram)
    least = np.where(felt > 0.0, np.sqrt(samples / np.where(felt > 0.0, felt, 1.0)), 0.0)
    size = np.maximum(np.abs(values), least)
    return np.where(size > 0.0, size, 1.0)


def _too_far(limits: Limits, far: Limits) -> str:
    worst = [
        (float(most / limit), f"joint {i + 1} reaches {name} {most:.3g}, expected at most {limit:.3g}")
        for name in ("angle", "speed", "torque")
        for i, (limit, most) in enumerate(zip(getattr(limits, name), getattr(far, name), strict=True))
    ]
    return f"no reference within the limits was found: {max(worst)[1]} (SI units)"
