"""The search of eq. (9), reduced to the parameters that the data reveals."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.data.standstill import REST_SPEED
from fitter.regression_sums.torque_sums import TorqueSums
from fitter.search.constrained_step import constrained_step
from fitter.search.standard_errors import sandwich_covariance
from fitter.search.whitened import whiten
from limbcal.errors import NotIdentifiable

#: A parameter hangs on one that was not revealed if that one's share in it is larger than this.
_SHARE = 1e-4


@dataclass(frozen=True)
class TorqueProblem:
    """What is sought, what is held, and the cost in between.

    Attributes
    ----------
    sums : TorqueSums
    prior : (n_base,)
        Values of all parameters that are not sought.
    free : (n_free,) int
        The parameters that are sought: the genes.
    revealed : (n_base,) bool
        Those that the data determines by themselves; free ones may hang on one that it does not.
    condition_number : float
        Of the free columns, each scaled to length one.
    W, z, rest : (n_free, n_free), (n_free,), float
        The cost of the genes x is ``|W x - z|^2 + rest``.
    inverse : (n_free, n_free)
        ``(W^T W)^-1``.
    """

    sums: TorqueSums
    prior: Floats
    free: NDArray[np.intp]
    revealed: NDArray[np.bool_]
    condition_number: float
    W: Floats
    z: Floats
    rest: float
    inverse: Floats

    def cost(self, genes: Floats) -> Floats:
        """Return eq. (9) for a population, without loss of digits near the optimum.

        Parameters
        ----------
        genes : (n_individual, n_free)

        Returns
        -------
        (n_individual,) [(N m)^2 summed over samples and joints]
        """
        residual = genes @ self.W.T - self.z
        return np.asarray(np.einsum("ij,ij->i", residual, residual) + self.rest, dtype=np.float64)

    def complete(self, genes: Floats) -> Floats:
        """Return all base parameters, (n_base,): the genes in their places, the prior elsewhere."""
        values = self.prior.copy()
        values[self.free] = genes
        return values

    def optimum(self) -> Floats:
        """Return the free parameters by least squares, (n_free,)."""
        return np.asarray(np.linalg.solve(self.W, self.z), dtype=np.float64)

    def optimum_within(self, lower: Floats, upper: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the free parameters by least squares within bounds, and which of them a bound stops.

        Parameters
        ----------
        lower, upper : (n_free,)

        Returns
        -------
        genes : (n_free,)
        stopped : (n_free,) bool
        """
        spread = np.sqrt(np.diag(self.inverse))  # the unit of each gene, which may be of any size
        limits, sides = np.concatenate([-lower / spread, upper / spread]), np.eye(len(spread))
        genes, binds = constrained_step(self.W * spread, self.z, limits, np.vstack([sides, -sides]))
        at_lower, at_upper = binds.reshape(2, -1)
        return np.where(at_lower, lower, np.where(at_upper, upper, genes * spread)), at_lower | at_upper

    def bounds(self) -> tuple[Floats, Floats]:
        """Return bounds that know nothing of the answer but how large the torque is.

        The parameters that explain the torque no worse than nothing at all (all of them zero) fill an
        ellipsoid. Zero and the optimum lie in it, wherever that is; so a box around zero, twice as wide as
        the ellipsoid, holds all of it.

        Returns
        -------
        lower, upper : (n_free,)
        """
        size = np.sqrt(self.z @ self.z + self.rest)
        upper = 2.0 * size * np.sqrt(np.diag(self.inverse))
        return -upper, upper

    def covariance(self, values: Floats) -> Floats:
        """Return the covariance of the free parameters at given base parameters, (n_free, n_free)."""
        if self.sums.variance is not None:
            return self.sums.variance * self.inverse
        grams = self.sums.gram.sum(axis=1)[:, self.free[:, None], self.free]
        scores = self.sums.scores(values)[:, self.free]
        return sandwich_covariance(self.W, grams, scores, self.sums.trial)

    def standard_errors(self, values: Floats) -> Floats:
        """Return the standard errors of all base parameters, NaN where they are not learnt, (n_base,)."""
        std = np.full(len(self.prior), np.nan)
        std[self.free] = np.sqrt(np.maximum(np.diag(self.covariance(values)), 0.0))
        return std


def torque_problem(sums: TorqueSums, prior: Floats, held: Mapping[int, float] | None = None) -> TorqueProblem:
    """Find out which base parameters some trials can determine, and set up the search for them.

    Parameters
    ----------
    sums : TorqueSums
    prior : (n_base,)
        Stays the value of a parameter that the data cannot determine.
    held : mapping from index to value, optional
        Parameters that are not sought.

    Raises
    ------
    NotIdentifiable
        If the data determines none of them, or if there is no torque, so that no mass can be determined.
    """
    start = np.array(prior, dtype=float)
    held = held or {}
    for index, value in held.items():
        start[index] = value
    given = np.array(sorted(held), dtype=np.intp)
    sought = np.setdiff1d(np.arange(len(start)), given)
    if not np.any(sums.gram):
        raise NotIdentifiable(
            f"no base parameter can be identified from {sums.samples} samples: no joint moved faster than "
            f"{REST_SPEED:g} rad/s (or m/s), below which it may stand still; check the units of t and q"
        )
    if not np.any(sums.power) and not np.any(start[given]):
        raise NotIdentifiable(
            f"the torque is zero in all {sums.samples} samples: a free motion tells no masses, only ratios; "
            "expected one mass, moment or inertia that is known (--fix), which sets the scale of all others"
        )
    gram, moment, power = sums.gram.sum(axis=(0, 1)), sums.moment.sum(axis=(0, 1)), sums.power.sum()
    power = power - 2.0 * moment[given] @ start[given] + start[given] @ gram[np.ix_(given, given)] @ start[given]
    moment = moment[sought] - gram[np.ix_(sought, given)] @ start[given]
    whitened = whiten(gram[np.ix_(sought, sought)], moment[:, None], np.array([power]))
    if not len(whitened.kept):
        raise NotIdentifiable(
            f"no base parameter can be identified from {sums.samples} samples: no joint moved, or none is sought"
        )
    order = np.argsort(whitened.kept)
    kept, folded = whitened.kept[order], whitened.folded
    revealed = np.zeros(len(start), dtype=bool)
    revealed[sought[whitened.kept]] = ~np.any(np.abs(whitened.dependence()) > _SHARE, axis=1)
    return TorqueProblem(
        sums=sums,
        prior=start,
        free=sought[kept],
        revealed=revealed,
        condition_number=whitened.condition_number(),
        W=whitened.W[:, kept],
        z=whitened.z[:, 0] - whitened.W[:, folded] @ start[sought[folded]],
        rest=float(whitened.rest[0]),
        inverse=whitened.inverse()[np.ix_(order, order)],
    )
