"""The search of eq. (9), reduced to the parameters that the data reveals."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.standard_errors import sandwich_covariance
from fitter.torque_sums import TorqueSums
from fitter.whitened import Whitened, whiten
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
        Those that the data tells by themselves; free ones may hang on one that it does not.
    """

    sums: TorqueSums
    prior: Floats
    free: NDArray[np.intp]
    revealed: NDArray[np.bool_]
    _whitened: Whitened

    @property
    def condition_number(self) -> float:
        """Condition number of the free columns, each scaled to length one."""
        return self._whitened.condition_number()

    def cost(self, genes: Floats) -> Floats:
        """Return eq. (9) for a population, without loss of digits near the optimum.

        Parameters
        ----------
        genes : (n_individual, n_free)

        Returns
        -------
        (n_individual,) [(N m)^2 summed over samples and joints]
        """
        residual = genes @ self._whitened.W[:, self._whitened.kept].T - self._target()
        return np.asarray(np.einsum("ij,ij->i", residual, residual) + self._whitened.rest[0])

    def complete(self, genes: Floats) -> Floats:
        """Return all base parameters, (n_base,): the genes in their places, the prior elsewhere."""
        values = self.prior.copy()
        values[self.free] = genes
        return values

    def optimum(self) -> Floats:
        """Return the free parameters by least squares, (n_free,)."""
        w = self._whitened
        return np.asarray(np.linalg.solve(w.W[:, w.kept], self._target()), dtype=np.float64)

    def bounds(self) -> tuple[Floats, Floats]:
        """Return bounds that know nothing of the answer but how large the torque is.

        The parameters that explain the torque no worse than nothing at all (all of them zero) fill an
        ellipsoid. Zero and the optimum lie in it, wherever that is; so a box around zero, twice as wide as
        the ellipsoid, holds all of it.

        Returns
        -------
        lower, upper : (n_free,)
        """
        size = np.sqrt(self._target() @ self._target() + self._whitened.rest[0])
        upper = 2.0 * size * np.sqrt(np.diag(self._whitened.inverse()))
        return -upper, upper

    def standard_errors(self, values: Floats) -> Floats:
        """Return the standard errors of all base parameters, NaN where they are not learnt, (n_base,)."""
        scores = self.sums.scores(values)[:, self.free]
        covariance = sandwich_covariance(self._whitened.inverse(), scores, self.sums.trial)
        std = np.full(len(self.prior), np.nan)
        std[self.free] = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        return std

    def _target(self) -> Floats:
        w = self._whitened
        return np.asarray(w.z[:, 0], dtype=np.float64)


def torque_problem(sums: TorqueSums, prior: Floats, held: Mapping[int, float] | None = None) -> TorqueProblem:
    """Find out which base parameters some trials can tell, and set up the search for them.

    Parameters
    ----------
    sums : TorqueSums
    prior : (n_base,)
        Stays the value of a parameter that the data can't tell.
    held : mapping from index to value, optional
        Parameters that are not sought.

    Raises
    ------
    NotIdentifiable
        If the data tells none of them, or if there is no torque, so that no mass can be told.
    """
    start = np.array(prior, dtype=float)
    for index, value in (held or {}).items():
        start[index] = value
    gram, moment = sums.gram.sum(axis=(0, 1)), sums.moment.sum(axis=(0, 1))
    power = float(sums.power.sum())
    sought = np.array([k for k in range(len(start)) if k not in (held or {})], dtype=np.intp)
    whitened = whiten(gram[np.ix_(sought, sought)], moment[sought, None], np.array([power]))
    free, folded = sought[whitened.kept], sought[whitened.folded]
    if not len(free):
        raise NotIdentifiable(
            f"no base parameter can be told from {sums.samples} samples: no joint moved, or none is sought"
        )
    if power == 0.0:
        raise NotIdentifiable(
            f"the torque is zero in all {sums.samples} samples: a free motion tells no masses, only ratios"
        )
    known = np.setdiff1d(np.arange(len(start)), free)
    rest = moment - gram[:, known] @ start[known]
    left = power - 2.0 * moment[known] @ start[known] + start[known] @ gram[np.ix_(known, known)] @ start[known]
    reduced = whiten(gram[np.ix_(free, free)], rest[free, None], np.array([max(float(left), 0.0)]))
    revealed = np.zeros(len(start), dtype=bool)
    revealed[free] = ~np.any(np.abs(whitened.dependence()) > _SHARE, axis=1)
    return TorqueProblem(sums, start, free[reduced.kept], revealed, _ordered(reduced))


def _ordered(whitened: Whitened) -> Whitened:
    return whitened
