"""The search for an arm's geometry while its motion is still coming in."""

from collections.abc import Collection, Mapping

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.model import Arm, Floats
from fitter.kinematics.gauge import Gauge, gauge
from fitter.kinematics.identifiability import identifiable, sought_by_default, with_parallel_axes
from fitter.kinematics.reliable import reliable
from fitter.kinematics.search_bounds import search_bounds
from fitter.kinematics.tip_basis import coefficients, expect_chain, geometry_names, geometry_of, jacobian, turning
from fitter.kinematics.tip_sums import TipSums, add_up, no_sums, tip_sums
from fitter.search.clusters import covariance_of_motions
from fitter.search.genetic import INDIVIDUALS_PER_GENE, POPULATION, GeneticAlgorithm
from fitter.search.standard_errors import sandwich_covariance
from limbcal.errors import ConfigError
from limbcal.suggestion import did_you_mean

#: Generations between two checks of identifiability.
_LOOK_AGAIN = 25
#: Least samples a block, to which stretches of one trial are joined: 50 ms of frames.
_BLOCK_SAMPLES = 50


class IncrementalKinematics:
    """A population of geometries and the sums of all frames so far.

    Parameters
    ----------
    arm : Arm
        Its geometry is the prior, and the middle of the bounds of angles and offsets.
    seed : int or numpy.random.Generator
    population : int, optional
        Default 100, or 8 individuals a parameter where that is more.
    bounds : mapping from name to (lower, upper), optional
        Default: a in 0..1 m, angles within 30 degrees and d within 0.5 m of the arm's.
    fixed : mapping from name to value, optional
        Parameters that are known and not searched.
    free : collection of str, optional
        Parameters to search although `fitter.kinematics.identifiability.sought_by_default` leaves them out.

    angle_noise : (n_joint,) [rad or m], optional
        Standard deviation of white noise in the angles, which is undone in the sums.

    Raises
    ------
    ConfigError
        If a name is not that of a parameter, or bounds are the wrong way round.
    """

    def __init__(
        self,
        arm: Arm,
        seed: int | np.random.Generator,
        *,
        population: int | None = None,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        fixed: Mapping[str, float] | None = None,
        free: Collection[str] = (),
        angle_noise: Floats | None = None,
    ) -> None:
        expect_chain(arm)
        names = geometry_names(arm.n_joint)
        unknown = sorted({*(bounds or {}), *(fixed or {}), *free} - set(names))
        if unknown:
            raise ConfigError(
                f"no geometric parameter is called {', '.join(unknown)}; there are {', '.join(names)}"
                f"{did_you_mean(unknown[0], names)}"
            )
        self.arm = arm
        self._revolute = turning(arm)
        self._best = geometry_of(arm)
        sought = sought_by_default(arm).ravel()
        for name in free:
            sought[names.index(name)] = True
        for name, value in (fixed or {}).items():
            sought[names.index(name)] = False
            self._best.flat[names.index(name)] = value
        self._prior = self._best.copy()
        self._genes = np.flatnonzero(sought)
        lower, upper = search_bounds(names, self._prior.ravel(), bounds or {})
        self._every_range = upper - lower
        self._bounds = lower[self._genes], upper[self._genes]
        self._range = (upper - lower)[self._genes]
        self.population = population or max(POPULATION, INDIVIDUALS_PER_GENE * len(self._genes))
        rng = np.random.default_rng(seed)
        #: A geometry like any other, in which nothing is parallel or zero by chance.
        self._anyhow = self._prior.copy()
        self._anyhow.flat[self._genes] = lower[self._genes] + self._range * rng.uniform(0.2, 0.8, len(self._genes))
        self._search = GeneticAlgorithm(lower[self._genes], upper[self._genes], rng, self.population)
        self._is_determined = np.zeros(len(self._genes), dtype=bool)
        self._parts: list[TipSums] = []
        self._angle_noise = angle_noise
        self._measured = self._total = no_sums(arm)
        self._whitened = self._total.whitened()
        self._changed = False
        self._tip_rms_m = np.nan
        self._polished: Floats | None = None

    @property
    def best(self) -> Floats:
        """Best geometry so far, (n_joint, 5): alpha, a, d, beta, theta offset; else the prior."""
        return self._best.copy()

    @property
    def is_determined(self) -> NDArray[np.bool_]:
        """Which of these parameters the frames so far determine, (n_joint, 5)."""
        is_determined = np.zeros(self._best.size, dtype=bool)
        is_determined[self._genes] = self._is_determined
        return is_determined.reshape(self._best.shape)

    @property
    def sought(self) -> NDArray[np.intp]:
        """Indices of the determined parameters in the flattened geometry, (n_determined,)."""
        return self._genes[self._is_determined]

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Bounds of the determined parameters, lower and upper, (n_determined,) each."""
        return self._bounds[0][self._is_determined], self._bounds[1][self._is_determined]

    @property
    def generations(self) -> int:
        """Generations so far; none passes before anything is identifiable."""
        return self._search.generation

    @property
    def samples(self) -> int:
        """Frames so far."""
        return self._total.samples

    @property
    def tip_rms_m(self) -> float:
        """Error of the best one's tip displacement, rms over all frames that there were in its generation."""
        return self._tip_rms_m

    def add(self, q: Floats, displacement: Floats, rest: Floats | None, trial: int = 0) -> None:
        """Add some frames.

        Parameters
        ----------
        q : (n_sample, n_joint) [rad or m]
        displacement : (n_sample, 3) [m]
            Of the tip since the rest at the start of its trial.
        rest : (n_joint,) or (n_rest, n_joint)
            Joint angles at that rest. None where ``q`` is a whole trial: then angles and tip are compared
            with their means.
        trial : int
            Stretches of one trial come one after the other.
        """
        if not len(q):
            return
        blocks = -(-len(q) // _BLOCK_SAMPLES)
        new = tip_sums(self.arm, q, displacement, rest, trial, blocks, self._angle_noise)
        if self._angle_noise is not None:
            self._measured = (self._measured + tip_sums(self.arm, q, displacement, rest, trial, 1)).total()
        self._total = (self._total + new).total()
        last = self._parts[-1] if self._parts else None
        if last is not None and last.samples < _BLOCK_SAMPLES and last.trial[-1] == trial and len(new.trial) == 1:
            joined = add_up([last, new]).total()
            self._parts[-1] = TipSums(joined.gram, joined.moment, joined.power, joined.count, new.trial)
        else:
            self._parts.append(new)
        self._changed = True

    def generation(self) -> float:
        """Breed one generation on all frames so far.

        Returns
        -------
        float
            Error of the best one's tip displacement, rms [m]; NaN as long as nothing is identifiable.
        """
        if self._changed:
            self._whiten()
        if self._search.generation % _LOOK_AGAIN == 0:
            self._look()
        if not np.any(self._is_determined):
            return np.nan
        genes = self._search.ask()
        costs = self._cost(genes)
        self._search.tell(costs)
        self._best, cost = self._geometries(self._search.best[None])[0], self._search.best_cost
        if self._polished is not None:
            polished = self._polished.flat[self._genes][None]
            if (polished_cost := float(self._cost(polished)[0])) <= cost:
                self._best, cost = self._geometries(polished)[0], polished_cost
        self._tip_rms_m = float(np.sqrt(cost / self._total.samples))
        return self._tip_rms_m

    def polish(self) -> None:
        """Move the best geometry to the optimum next to it, by Gauss-Newton steps within the bounds."""
        which, found = self._genes[self._is_determined], self._best.copy()

        def residual(genes: Floats) -> Floats:
            found.flat[which] = genes
            return np.asarray(self._residual(found[None])[0].ravel())

        def slopes(genes: Floats) -> Floats:
            found.flat[which] = genes
            return self._slopes(jacobian(self._revolute, found, which)[:, :, 1:]).T

        low, high = self.bounds
        inside = np.clip(self._best.flat[which], low, high)
        answer = scipy.optimize.least_squares(
            residual, inside, slopes, (low, high), xtol=1e-15, ftol=1e-15, gtol=1e-15
        )
        cost = 2.0 * answer.cost + float(self._whitened.rest.sum())
        if cost <= self._tip_rms_m**2 * self._total.samples:
            found.flat[which] = answer.x
            self._best, self._tip_rms_m = found, float(np.sqrt(cost / self._total.samples))
            self._polished = found.copy()

    def scattered(self) -> Floats:
        """Return the covariance of the determined parameters, in the order of `sought`, from their residuals."""
        return sandwich_covariance(*self._scores())

    def known(self, tracked: bool) -> tuple[Floats, float]:
        """Return the same covariance with what motions share, and its degrees of freedom.

        Parameters
        ----------
        tracked : bool
            Whether a tracker made the motions, see `fitter.search.clusters.covariance_of_motions`.
        """
        sums = self._scores()
        return covariance_of_motions(sandwich_covariance(*sums), *sums, tracked)

    def _scores(self) -> tuple[Floats, Floats, Floats, NDArray[np.intp]]:
        """Return a root of the normal matrix and, of every block, Gram matrix, score and motion."""
        which = self.sought
        sums = add_up(self._parts).thinned()
        self._parts = [sums]
        J = jacobian(self._revolute, self._best, which)[:, :, 1:]
        C = coefficients(self._revolute, self._best[None])[0, :, 1:]
        grams = np.einsum("kxa,bac,lxc->bkl", J, sums.gram, J, optimize=True)
        scores = np.einsum("kxa,bax->bk", J, sums.moment - sums.gram @ C.T)
        W = np.asarray(np.linalg.qr(self._slopes(J).T).R)
        return W, grams, scores, sums.trial

    def gauge(self) -> tuple[Gauge, ...]:
        """Return which parameters show only together, or not at all, in the frames so far."""
        everything = np.arange(self._best.size)
        scale = 1.0 / np.sqrt(max(self.samples, 1))
        geometry = with_parallel_axes(self.arm, self._best)
        effects = self._slopes(jacobian(self._revolute, geometry, everything)[:, :, 1:])
        C = coefficients(self._revolute, geometry[None])[0, :, 1:]
        base = self._slopes(np.cross(np.eye(3)[:, :, None], C[None], axis=1)) * np.pi / 3.0
        ranges = np.where(self._every_range > 0.0, self._every_range, 1.0)
        return gauge(geometry_names(self.arm.n_joint), effects * ranges[:, None] * scale, base * scale)

    def promise(self) -> float:
        """Return the share by which a Gauss-Newton step would lower the cost of the best one."""
        J = jacobian(self._revolute, self._best, self._genes[self._is_determined])[:, :, 1:]
        residual = self._residual(self._best[None])[0].ravel()
        step, *_ = np.linalg.lstsq(self._slopes(J).T, residual, rcond=None)
        lowered = float(np.sum((self._slopes(J).T @ step) ** 2))
        floor = 1e-18 * float(self._total.power.sum())
        return lowered / max(float(residual @ residual) + float(np.sum(self._whitened.rest)), floor, 1e-300)

    def _whiten(self) -> None:
        total, self._changed = self._total, False
        if self._angle_noise is None:
            self._whitened = total.whitened()
            return
        parts = total.gram[0], total.moment[0], total.power[0]
        self._whitened = reliable(self._measured.whitened(), *parts, total.samples)

    def _look(self) -> None:
        """Find out which genes are identifiable from the sums."""
        is_determined = self._identifiable(self._anyhow, np.ones(len(self._genes), dtype=bool))
        if self._search.generation:
            is_determined = self._identifiable(self._best, is_determined)
        self._is_determined = is_determined
        self._search.hold(~is_determined)

    def _identifiable(self, geometry: Floats, among: NDArray[np.bool_]) -> NDArray[np.bool_]:
        which = self._genes[among]
        effects = self._slopes(jacobian(self._revolute, geometry, which)[:, :, 1:])
        effects *= self._range[among, None] / np.sqrt(max(self.samples, 1))
        is_determined = np.zeros(len(among), dtype=bool)
        is_determined[among] = identifiable(effects, which)
        return is_determined

    def _slopes(self, J: Floats) -> Floats:
        return np.asarray((J @ self._whitened.W.T).reshape(len(J), -1), dtype=np.float64)

    def _geometries(self, genes: Floats) -> Floats:
        flat = np.tile(self._prior.ravel(), (len(genes), 1))
        flat[:, self._genes[self._is_determined]] = genes[:, self._is_determined]
        return flat.reshape(len(genes), *self._prior.shape)

    def _residual(self, geometries: Floats) -> Floats:
        C = coefficients(self._revolute, geometries)[:, :, 1:]
        return np.asarray(C @ self._whitened.W.T - self._whitened.z.T, dtype=np.float64)

    def _cost(self, genes: Floats) -> Floats:
        residual = self._residual(self._geometries(genes)).reshape(len(genes), -1)
        return np.asarray(np.einsum("ij,ij->i", residual, residual) + self._whitened.rest.sum())
