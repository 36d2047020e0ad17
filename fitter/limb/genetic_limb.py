"""The paper's incremental genetic algorithm on the bundle fit's own cost, without starting values (section 5).

An individual is a geometry. Marker places and angles, in which the cost is easy, are projected out
(`projected_cost`) from those of the best individual of the generation before; at first angles are at the middle of
their ranges and places anywhere. Since places may have ended in a minimum of their own, as of a cluster that is
turned about its segment's axis, those of one link, or of all, begin anew in every generation. Frames come in the
order of time; the individuals of the last batch of frames start the next.
"""

from dataclasses import replace

import numpy as np

from arm.marker_kinematics import Integers
from arm.model import Floats
from fitter.limb.bundle import Task, rescaled
from fitter.limb.free_geometry import Geometry
from fitter.limb.inverse_kinematics import follow
from fitter.limb.marker_observations import MarkerModel
from fitter.limb.projected_cost import projected_cost
from fitter.limb.search_box import REACH_M, SearchBox
from fitter.search.genetic import INDIVIDUALS_PER_GENE, POPULATION, GeneticAlgorithm

#: A population is close when its better quarter differs by less than this in cost, minus twice a log posterior, of
#: which 1 is one standard error of one number.
CLOSE = 1.0
#: Steps of each frame's angles by themselves, then of places and angles together: from anywhere, from a geometry
#: that may be far, from one nearby, and from one so close that the cost is quadratic.
_ANYWHERE, _FAR, _NEAR, _CLOSE_BY = (20, 10), (3, 3), (0, 2), (0, 1)
#: Steps of places that begin anew.
_ANEW = (0, 10)
#: Period in generations with which all links' places begin anew; in the others those of one link do.
_ALL_ANEW = 4


class IncrementalLimb:
    """A population of geometries, and the frames so far.

    Parameters
    ----------
    task : Task
        The bundle fit's.
    markers : MarkerModel
        Of which the places are not looked at.
    box : SearchBox
        Where the population is drawn.
    seed : int
    population : int, optional
        Default 100, or 8 individuals a free number where that is more.
    """

    def __init__(
        self, task: Task, markers: MarkerModel, box: SearchBox, seed: int, population: int | None = None
    ) -> None:
        n_free = len(task.free.std)
        self._task, self._box = task, box
        self.population = population or max(POPULATION, INDIVIDUALS_PER_GENE * n_free)
        self._rng = np.random.default_rng(seed)
        self._search = GeneticAlgorithm(box.lower, box.upper, self._rng, self.population)
        self._of_geometry, self._of_place = np.split(task.prior.information, [n_free])
        self.geometry = box.geometry(self._search.best)
        self.markers = replace(markers, place=self._anywhere(len(markers.names)))
        self.rows: Integers = np.empty(0, dtype=np.int64)
        self.q = np.empty((0, len(task.angles.mean)))
        self._frames, self._share = task.frames.rows(self.rows), np.empty(0)
        self._batches = 0
        #: Cost of the best, and how much more the best quarter's last one costs.
        self.cost, self.spread = np.inf, np.inf

    @property
    def generations(self) -> int:
        """Generations so far."""
        return self._search.generation

    def add(self, rows: Integers) -> None:
        """Take in more of the task's frames, later ones than those before; the scale is learnt anew (EM).

        Those taken in stand for all frames up to the last of them.

        Parameters
        ----------
        rows : (n,) int64
        """
        self.rows = np.concatenate([self.rows, rows])
        self._frames = self._task.frames.rows(self.rows)
        share = self._task.share[: self.rows[-1] + 1].sum() / len(self.rows)
        self._share = np.full(len(self.rows), share)
        self.q = np.vstack([self.q, self._middle(len(rows))])
        self._batches += 1
        self.spread = np.inf
        if self.generations:
            self.q = self._followed(self.markers, self.q)
            self.markers = rescaled(self.geometry, self.markers, self._frames, self.q)

    def generation(self) -> float:
        """Let one generation pass; return the cost of the best.

        Returns
        -------
        float
            Minus twice the log posterior, up to a constant, as `fitter.limb.bundle.cost_of` has it.
        """
        if not self.generations:
            steps = _ANYWHERE
        elif self._batches == 1:
            steps = _FAR
        else:
            steps = _CLOSE_BY if self.spread < CLOSE else _NEAR
        genes = self._search.ask()
        costs, self.cost = np.empty(len(genes)), np.inf
        place, q = self.markers.place, self.q
        for k, own in enumerate(genes):
            geometry = self._box.geometry(own)
            costs[k], its_place, its_q = self._projected(geometry, place, q, steps)
            if costs[k] < self.cost:
                self.geometry, self.cost, self.q = geometry, float(costs[k]), its_q
                self.markers = replace(self.markers, place=its_place)
        self._search.tell(costs)
        if not self.spread < CLOSE:
            self._begin_anew()
        self.spread = float(np.quantile(costs, 0.25) - costs.min())
        return self.cost

    def _projected(
        self, geometry: Geometry, place: Floats, q: Floats, steps: tuple[int, int]
    ) -> tuple[float, Floats, Floats]:
        """Return the cost of a geometry, and the places and angles that suit it."""
        task, place, q = self._task, place.copy(), q.copy()
        chain = replace(self.markers, place=place).chain(geometry)
        cost = projected_cost(
            chain, self._frames, self._share, q, self.markers.std**2, task.angles,
            task.prior.place, self._of_place, steps,
        )  # fmt: skip
        cost += float(self._of_geometry @ geometry.away(task.free, task.prior.geometry) ** 2)
        return cost, chain.place, q

    def _begin_anew(self) -> None:
        """Try other places of one link's markers, or of all, of the best geometry; keep them if they cost less."""
        markers = self.markers
        is_all = self.generations % _ALL_ANEW == 0
        link = self._rng.choice(np.unique(markers.link))
        on = (markers.link == link) | is_all
        place = np.where(on[:, None], self._anywhere(len(on)), markers.place)
        begin = self._middle(len(self.q)) if is_all else self.q
        q = self._followed(replace(markers, place=place), begin)
        cost, place, q = self._projected(self.geometry, place, q, _ANEW)
        if cost < self.cost:
            self.cost, self.q, self.markers = cost, q, replace(markers, place=place)

    def _followed(self, markers: MarkerModel, q: Floats) -> Floats:
        """Return the best geometry's angles from others, anew from many postures where markers are far off."""
        chain = markers.chain(self.geometry)
        return follow(chain, self._frames, markers.std, self._task.angles, self.generations, q)

    def _anywhere(self, n: int) -> Floats:
        return np.asarray(self._rng.uniform(-REACH_M, REACH_M, (n, 3)))

    def _middle(self, n: int) -> Floats:
        return np.tile(self._task.angles.mean, (n, 1))
