"""Search algorithms of other projects, each behind the same door, with the settings that it comes with.

They search the unit box; what they are given for a cost takes a whole generation at once, ``(n, n_gene)`` in and
``(n,)`` out, where their interface has a place for that. The packages are those of the extra ``bench``.
"""

import random
from collections.abc import Callable, Sequence

import cma
import numpy as np
from deap import algorithms, base, creator, tools
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from scipy.optimize import differential_evolution

from arm.model import Floats
from fitter.search.genetic import GeneticAlgorithm

#: The cost of a generation.
Cost = Callable[[Floats], Floats]
#: Searches with a cost, number of genes, population and generations.
Search = Callable[[Cost, int, int, int], None]


def limbcal_ga(cost: Cost, genes: int, population: int, generations: int) -> None:
    """Search with our own algorithm."""
    search = GeneticAlgorithm(np.zeros(genes), np.ones(genes), np.random.default_rng(0), population)
    for _ in range(generations):
        search.tell(cost(search.ask()))


def pymoo_ga(cost: Cost, genes: int, population: int, generations: int) -> None:
    """Search with pymoo's genetic algorithm: tournament, simulated binary crossover, polynomial mutation."""

    class Wrapped(Problem):
        def __init__(self) -> None:
            super().__init__(n_var=genes, n_obj=1, xl=0.0, xu=1.0)

        def _evaluate(self, x: Floats, out: dict[str, Floats], *_args: object, **_named: object) -> None:
            out["F"] = cost(x)[:, None]

    minimize(Wrapped(), GA(pop_size=population), ("n_gen", generations), seed=0)


def deap_ga(cost: Cost, genes: int, population: int, generations: int) -> None:
    """Search with DEAP's `eaSimple`: tournament, blend crossover, Gaussian mutation."""
    if not hasattr(creator, "Genes"):
        creator.create("Least", base.Fitness, weights=(-1.0,))
        creator.create("Genes", list, fitness=creator.Least)

    def all_at_once(_evaluate: object, individuals: Sequence[list[float]]) -> list[tuple[float]]:
        some = list(individuals)
        return [(float(value),) for value in cost(np.array(some))] if some else []

    random.seed(0)
    toolbox = base.Toolbox()
    toolbox.register("genes", tools.initRepeat, creator.Genes, random.random, n=genes)
    toolbox.register("map", all_at_once)
    toolbox.register("evaluate", cost)
    toolbox.register("mate", tools.cxBlend, alpha=0.5)
    toolbox.register("mutate", tools.mutGaussian, mu=0.0, sigma=0.1, indpb=0.2)
    toolbox.register("select", tools.selTournament, tournsize=3)
    first = [toolbox.genes() for _ in range(population)]
    algorithms.eaSimple(first, toolbox, cxpb=0.5, mutpb=0.2, ngen=generations - 1, verbose=False)


def scipy_de(cost: Cost, genes: int, population: int, generations: int) -> None:
    """Search with scipy's differential evolution, without its polish."""
    differential_evolution(
        lambda x: cost(x.T),
        [(0.0, 1.0)] * genes,
        init=np.random.default_rng(0).uniform(size=(population, genes)),
        maxiter=generations - 1,
        tol=0.0,
        atol=0.0,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=0,
    )


def pycma(cost: Cost, genes: int, population: int, generations: int) -> None:
    """Search with CMA-ES; it may end before its generations, when it has converged."""
    options = {"popsize": population, "maxiter": generations, "bounds": [0.0, 1.0], "seed": 1, "verbose": -9}
    search = cma.CMAEvolutionStrategy(np.full(genes, 0.6), 0.3, options)
    while not search.stop():
        asked = search.ask()
        search.tell(asked, cost(np.array(asked)).tolist())


SEARCHES: dict[str, tuple[str | None, Search]] = {
    "limbcal's GA": (None, limbcal_ga),
    "pymoo GA": ("pymoo", pymoo_ga),
    "DEAP eaSimple": ("deap", deap_ga),
    "scipy differential_evolution": ("scipy", scipy_de),
    "pycma CMA-ES": ("cma", pycma),
}
