"""The genetic algorithm of section 5: any cost, no starting values, no derivatives.

One generation is the paper's steps 3 to 6. Evaluate everybody; remove the worst; mutate a few; cross the
others over to N new individuals. The paper leaves the crossover open. Ours has many parents: a child is the
survivors' mean plus a Gaussian-weighted sum of steps, where a step leads from the mean that an individual was
born around to where it survived. Weighted sums don't care how genes are scaled or correlated, so a long
narrow valley costs no more generations than a round one; and since steps are taken from the old mean, the
population widens along a slope and narrows around an optimum, also when the optimum moves because data came
in. (Steps of several generations are kept, as many as it takes to know their spread in every direction; this
is the rank-mu update of Hansen's CMA-ES, written as a crossover.)
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arm.model import Floats
from limbcal.compiled import compiled

#: The paper's N, and how many individuals there should be for each gene where there are many.
POPULATION = 100
INDIVIDUALS_PER_GENE = 8
#: The share of a generation that survives step 4, and the share that step 5 mutates.
_SURVIVE = 0.3
_MUTATE = 0.05
#: The best individual lives on unchanged.
_ELITE = 1
#: Steps that are remembered for every gene: fewer, and their spread collapses in directions by chance.
_STEPS_PER_GENE = 15
_GENERATIONS_KEPT = 4
#: A mutation changes a gene by its range times ten to a random power between this one and 0.
_FINEST_MUTATION = -8.0
#: Children scatter at least by this fraction of a gene's range, or a population that has found its optimum
#: would be too narrow to notice that it moves.
_LEAST_SCATTER = 1e-12
_SMALLEST_POPULATION = 10


class GeneticAlgorithm:
    """A population within bounds with an ask-and-tell interface, generation by generation.

    The costs of one generation are not used in the next, so the objective may change in between.

    Parameters
    ----------
    lower, upper : (n_gene,)
        Bounds. A gene whose bounds are equal is fixed (the paper's "restricted conditions").
    rng : numpy.random.Generator
        The same generator state and the same costs give the same bytes.
    population : int
        N of step 2, at least 10.

    Raises
    ------
    ValueError
        If bounds are not finite, a lower one exceeds its upper one, or the population is too small.
    """

    def __init__(
        self, lower: ArrayLike, upper: ArrayLike, rng: np.random.Generator, population: int = POPULATION
    ) -> None:
        self._lower = np.array(lower, dtype=float)
        self._upper = np.array(upper, dtype=float)
        if self._lower.ndim != 1 or self._lower.shape != self._upper.shape:
            raise ValueError(f"bounds have shapes {self._lower.shape} and {self._upper.shape}, expected (n,)")
        width = self._upper - self._lower
        if not (np.all(np.isfinite(width)) and np.all(width >= 0.0)):
            raise ValueError(f"bounds must be finite and ordered, found {self._lower} and {self._upper}")
        if population < _SMALLEST_POPULATION:
            raise ValueError(f"population is {population}, expected at least {_SMALLEST_POPULATION}")
        self._rng = rng
        self._fixed = width == 0.0
        self._held = self._fixed.copy()
        self._population = self._lower + width * rng.random((population, width.size))  # step 2
        self._centre = 0.5 * (self._lower + self._upper)
        self._best, self._best_cost = self._population[0].copy(), np.inf
        self._survivors = max(2, round(_SURVIVE * population))
        self._mutants = max(1, round(_MUTATE * population))
        kept = max(_GENERATIONS_KEPT, -(-_STEPS_PER_GENE * width.size // self._survivors))
        self._steps = np.zeros((kept * self._survivors, width.size))
        self.generation = 0

    @property
    def best(self) -> Floats:
        """The cheapest individual of the last generation whose costs are known, (n_gene,)."""
        return np.array(self._best)

    @property
    def best_cost(self) -> float:
        """What the best one cost in its generation; infinite before the first."""
        return self._best_cost

    @property
    def spread(self) -> Floats:
        """Standard deviation of every gene over the population, (n_gene,)."""
        return np.asarray(self._population.std(axis=0), dtype=np.float64)

    def hold(self, genes: NDArray[np.bool_]) -> None:
        """Set some genes aside until the next call, for as long as the objective does not know them.

        A held gene keeps its first, wide scatter over the population, so the search for it starts afresh
        when it is let go.

        Parameters
        ----------
        genes : (n_gene,) bool
        """
        held = genes | self._fixed
        freed = self._held & ~held
        self._centre[freed] = self._population[:, freed].mean(axis=0)
        self._held = held

    def ask(self) -> Floats:
        """Return the generation that is to be evaluated, survivors included, (N, n_gene)."""
        return np.array(self._population)

    def tell(self, costs: Floats) -> None:
        """Take the costs of the generation and breed the next one: steps 3 to 6.

        Parameters
        ----------
        costs : (N,)
            Smaller is better; NaN is worst.

        Raises
        ------
        ValueError
            If there is not one cost an individual.
        """
        n, n_gene = self._population.shape
        if np.shape(costs) != (n,):
            raise ValueError(f"costs have shape {np.shape(costs)}, expected ({n},)")
        order = np.argsort(costs, kind="stable")  # step 3; NaN comes last
        self._best = self._population[order[0]].copy()
        self._best_cost = float(costs[order[0]])
        place = self.generation * self._survivors % len(self._steps)
        self.generation += 1
        filled = min(self.generation * self._survivors, len(self._steps))
        children = np.empty_like(self._population)
        next_generation(
            self._population,
            order,
            self._lower,
            self._upper,
            self._held,
            self._survivors,
            self._centre,
            self._steps,
            place,
            filled,
            self._rng.random((self._mutants, 1 + 2 * n_gene)),
            self._rng.standard_normal((n - _ELITE - self._mutants, n_gene)),
            children,
        )
        self._population = children


@compiled
def next_generation(
    population: Floats,
    order: NDArray[np.intp],
    lower: Floats,
    upper: Floats,
    held: NDArray[np.bool_],
    survivors: int,
    centre: Floats,
    steps: Floats,
    place: int,
    filled: int,
    uniform: Floats,
    normal: Floats,
    children: Floats,
) -> None:
    """Fill in the next generation; ``centre`` and the ring of ``steps`` move on with it.

    ``order`` sorts the population by cost. ``steps`` has ``filled`` valid rows and takes new ones at
    ``place``. ``uniform`` (mutants, 1 + 2 n_gene) and ``normal`` (crossed, n_gene) are all its chance.
    """
    n, n_gene = population.shape
    mean = np.zeros(n_gene)
    for i in range(survivors):  # step 4: whoever comes later in the order is gone
        for k in range(n_gene):
            if not held[k]:
                steps[place + i, k] = population[order[i], k] - centre[k]
                mean[k] += population[order[i], k] / survivors
            else:
                steps[place + i, k] = 0.0
    centre[:] = mean
    triangle = triangular_factor(steps[:filled])
    keep_apart(triangle, _LEAST_SCATTER * (upper - lower) * ~held)

    elite = n - uniform.shape[0] - normal.shape[0]
    for row in range(n):
        child, mutant, crossed = children[row], row - elite, row - elite - uniform.shape[0]
        if mutant < 0:
            child[:] = population[order[row]]
        elif crossed < 0:  # step 5
            child[:] = population[order[int(uniform[mutant, 0] * survivors)]]
            mutate(child, uniform[mutant, 1:], lower, upper)
        else:  # step 6
            cross_over(child, mean, triangle, normal[crossed])
        for k in range(n_gene):
            if held[k]:
                child[k] = population[row, k]
            else:
                child[k] = reflected(child[k], lower[k], upper[k])


@compiled
def keep_apart(triangle: Floats, least: Floats) -> None:
    """Give every gene its least scatter."""
    for k in range(least.size):
        if abs(triangle[k, k]) < least[k]:
            triangle[k, k] = least[k]


@compiled
def cross_over(child: Floats, mean: Floats, triangle: Floats, weight: Floats) -> None:
    """Fill in the mean plus a Gaussian-weighted sum of all steps.

    Steps S = Q R; a sum with independent Gaussian weights over the rows of S is distributed as one over the
    rows of R, of which there are only as many as genes.
    """
    child[:] = 0.0
    for i in range(child.size):
        for k in range(i, child.size):
            child[k] += weight[i] * triangle[i, k]
    for k in range(child.size):
        child[k] += mean[k]


@compiled
def mutate(child: Floats, uniform: Floats, lower: Floats, upper: Floats) -> None:
    """Change one gene on average, by anything from its whole range to a hundred-millionth of it."""
    n_gene = child.size
    for k in range(n_gene):
        choice = uniform[k] * n_gene
        if choice < 1.0:
            sign = 1.0 if choice < 0.5 else -1.0
            child[k] += sign * (upper[k] - lower[k]) * 10.0 ** (_FINEST_MUTATION * uniform[n_gene + k])


@compiled
def reflected(value: float, lower: float, upper: float) -> float:
    """Return a value beyond a bound as far inside of it as it was outside."""
    width = upper - lower
    turn = (value - lower) % (2.0 * width)
    inside = lower + (turn if turn <= width else 2.0 * width - turn)
    return min(max(inside, lower), upper)


@compiled
def triangular_factor(steps: Floats) -> Floats:
    """Return R / sqrt(n) of ``steps = Q R`` (n, k), by Householder reflections; rows past n are zero.

    Columns lie in memory one after another, for that is how they are read.
    """
    A = steps.T.copy()
    n_col, n = A.shape
    R = np.zeros((n_col, n_col))
    for k in range(min(n, n_col)):
        own = A[k, k:]
        norm = np.sqrt(inner_product(own, own))
        if norm > 0.0:
            norm = -norm if own[0] > 0.0 else norm
            for i in range(own.size):
                own[i] /= -norm
            own[0] += 1.0
            for j in range(k + 1, n_col):
                other = A[j, k:]
                share = inner_product(own, other) / own[0]
                for i in range(own.size):
                    other[i] -= share * own[i]
        R[k, k] = norm
        for j in range(k + 1, n_col):
            R[k, j] = A[j, k]
    R /= np.sqrt(n)
    return R


@compiled
def inner_product(a: Floats, b: Floats) -> float:
    """Return the sum of products, in four parts that a processor adds side by side: always in the same order."""
    s, t, u, v, whole = 0.0, 0.0, 0.0, 0.0, a.size - a.size % 4
    for i in range(0, whole, 4):
        s += a[i] * b[i]
        t += a[i + 1] * b[i + 1]
        u += a[i + 2] * b[i + 2]
        v += a[i + 3] * b[i + 3]
    for i in range(whole, a.size):
        s += a[i] * b[i]
    return (s + t) + (u + v)
