"""How far lengths, centres and axes may be off, from parts of the recordings that are left out.

Skin moves coherently, so errors from residuals that are taken for independent are some ten times too small. What
differs when a part is left out does not depend on that. One Gauss-Newton step from the answer of all parts is
enough for each, since parts' normal equations are kept apart (`normal_equations`). What is off alike in all parts
comes on top (`functional_error`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.body.landmarks import LimbMap
from arm.model import Floats
from fitter.functional.disjoint import jackknife, rms_apart
from fitter.limb.bundle import Bundle, Task, shared_away
from fitter.limb.free_geometry import Geometry
from fitter.limb.functional_error import systematic_std_m

#: Standard deviation of the posterior, as a share of the prior's, from which on nothing was learnt of a number.
LEARNT = 0.7


@dataclass(frozen=True)
class Derived:
    """Derived quantities of a limb: each as a vector, in a frame that does not depend on gauge.

    Attributes
    ----------
    lengths : mapping of str to float [m]
    centres : mapping of str to (str, (3,))
        Segment, and the place in its frame: that of its markers as the fit of all frames has them.
    axes : mapping of str to (str, (3,))
        Segment and unit direction.
    """

    lengths: dict[str, float]
    centres: dict[str, tuple[str, Floats]]
    axes: dict[str, tuple[str, Floats]]

    def vector(self) -> Floats:
        """Return all numbers in one row."""
        parts = [np.array(list(self.lengths.values()))]
        parts += [place for _, place in self.centres.values()] + [way for _, way in self.axes.values()]
        return np.concatenate(parts)


@dataclass(frozen=True)
class Errors:
    """Standard errors, and how far disjoint trials are apart.

    Attributes
    ----------
    free_std : (n_free,)
    learnt : (n_free,) of bool
    derived_covariance : (n, n)
        Of `Derived.vector`.
    apart : tuple of Derived
        What each trial by itself (each half of the only one) says.
    n_part : int
    """

    free_std: Floats
    learnt: NDArray[np.bool_]
    derived_covariance: Floats
    apart: tuple[Derived, ...]
    n_part: int

    def apart_m(self, kind: str, name: str) -> float:
        """Return how far disjoint trials are apart in a centre [m] or an axis [rad], rms."""
        return rms_apart([getattr(one, kind)[name][1] for one in self.apart])

    def with_systematic(self, std_m: float, free: Sequence[int], numbers: Sequence[int]) -> "Errors":
        """Return the errors with one that all parts share, of some free and some derived numbers."""
        free_var, covariance = self.free_std**2, self.derived_covariance.copy()
        free_var[list(free)] += std_m**2
        covariance[list(numbers), list(numbers)] += std_m**2
        return replace(self, free_std=np.sqrt(free_var), derived_covariance=covariance)


def derived(
    where: LimbMap, geometry: Geometry, links: NDArray[np.int64], place: Floats, reference: Floats
) -> Derived:
    """Return what follows from a geometry and marker places.

    Parameters
    ----------
    where : LimbMap
    geometry : Geometry
    links : (m,) int64
    place, reference : (m, 3) [m]
        Where markers are, and where the fit of all frames has them: centres are given in its frames.
    """
    numbers, k = geometry.numbers, where.balls[0]
    upper, lower = ("upper_arm", "forearm") if "elbow" in where.centres else ("thigh", "shank")
    turns = where.parts[f"{lower}_{where.side}"].link == k + 4
    lengths = {upper: abs(numbers[k + 2, 2]), lower: abs(numbers[k + 4, 2]) if turns else numbers[k + 3, 1]}
    if k:
        lengths = {"girdle": float(np.hypot(numbers[1, 1], numbers[1, 2])), **lengths}
    first = next(iter(where.centres))
    centres = {f"{first}_{where.side}": (where.base, geometry.base_p)}
    axes: dict[str, tuple[str, Floats]] = {}
    for segment, part in where.parts.items():
        on_it = links == part.link
        R, shift = towards(place[on_it], reference[on_it])
        if part.ends in where.centres:
            end = np.array([numbers[part.link, 1], 0.0, 0.0])
            centres[f"{part.ends}_{where.side}"] = (segment, R @ end + shift)
        named = [name for name, i in where.axes.items() if i == part.link + 1]
        if named:
            alpha, beta = numbers[part.link + 1, 0], numbers[part.link + 1, 3]
            way = np.array([np.cos(alpha) * np.sin(beta), -np.sin(alpha), np.cos(alpha) * np.cos(beta)])
            axes[f"{named[0]}_{where.side}"] = (segment, R @ way)
    return Derived({name: float(x) for name, x in lengths.items()}, centres, axes)


def towards(place: Floats, reference: Floats) -> tuple[Floats, Floats]:
    """Return the rotation and shift that bring places nearest to their reference; only a shift of fewer than 3."""
    if not len(place):
        return np.eye(3), np.zeros(3)
    middle, aim = place.mean(axis=0), reference.mean(axis=0)
    if len(place) < 3:
        return np.eye(3), aim - middle
    U, _, Vt = np.linalg.svd((reference - aim).T @ (place - middle))
    U[:, 2] *= np.sign(np.linalg.det(U) * np.linalg.det(Vt))
    R = U @ Vt
    return R, aim - R @ middle


def errors(where: LimbMap, task: Task, bundle: Bundle, n_part: int, halves: Sequence[Bundle]) -> Errors:
    """Return the errors of a bundle fit of one limb.

    Parameters
    ----------
    where : LimbMap
    task : Task
    bundle : Bundle
        With its normal equations part by part.
    n_part : int
    halves : sequence of Bundle
        Fits of disjoint trials by themselves (`disjoint_fits`).
    """
    markers = bundle.markers

    def derive(geometry: Geometry, place: Floats) -> Derived:
        return derived(where, geometry, markers.link, place, markers.place)

    found = errors_of(task, bundle, n_part, halves, derive)
    if where.balls[0]:  # with a girdle before it the first centre is another
        return found
    off = systematic_std_m(next(iter(where.centres)))
    near = [task.free.names.index(name) for name in ("base_x", "base_y", "base_z", "d3")]
    two_lengths = 2
    return found.with_systematic(off, near, [0, *range(two_lengths, two_lengths + 3)])


def errors_of(
    task: Task,
    bundle: Bundle,
    n_part: int,
    halves: Sequence[Bundle],
    derive: Callable[[Geometry, Floats], Derived],
) -> Errors:
    """Return the errors of a bundle fit, but for what is off alike in all parts.

    Parameters
    ----------
    task, bundle, n_part, halves
        As `errors` takes them.
    derive : callable
        Given a geometry and marker places, (m, 3), returns what follows from them.
    """
    markers, n_free = bundle.markers, len(task.free.std)
    information = task.prior.information
    prior_gradient = information * shared_away(task, bundle.geometry, markers.place)

    def step(use: NDArray[np.bool_]) -> Floats:
        # the rest stands for all, so that the prior counts alike
        more = len(use) / max(int(use.sum()), 1)
        S, b = more * bundle.S[use].sum(axis=0), more * bundle.b[use].sum(axis=0)
        return np.asarray(np.linalg.solve(S + np.diag(information), b - prior_gradient))

    def derived_of(use: NDArray[np.bool_]) -> Floats:
        return derived_at(step(use))

    def derived_at(shared: Floats) -> Floats:
        geometry = bundle.geometry.moved(task.free, shared[:n_free])
        return derive(geometry, markers.place + shared[n_free:].reshape(-1, 3)).vector()

    posterior = np.linalg.inv(bundle.S.sum(axis=0) + np.diag(information))
    formal = np.sqrt(np.diag(posterior)[:n_free])
    spread = np.sqrt(np.diag(jackknife(lambda use: step(use)[:n_free], n_part)))
    apart = tuple(derive(half.geometry, half.markers.place) for half in halves)
    by_parts = _larger(jackknife(derived_of, n_part), _carried(derived_at, posterior))
    # what the motion leaves open stays at the prior whichever part is left out: its error is the posterior's
    return Errors(
        np.fmax(spread, formal),
        formal < LEARNT * task.free.std,
        _larger(by_parts, _of_mean(apart)) if len(apart) > 1 else by_parts,
        apart,
        n_part,
    )


def _of_mean(apart: Sequence[Derived]) -> Floats:
    """Return the covariance of the mean of disjoint fits, from how they scatter.

    One Gauss-Newton step has the slopes of the answer of all parts: where one trial says another thing than the
    rest, it goes less far than a fit of that trial does.
    """
    vectors = np.array([one.vector() for one in apart])
    return np.diag(np.var(vectors, axis=0, ddof=1) / len(vectors))


def _carried(derived_at: Callable[[Floats], Floats], covariance: Floats) -> Floats:
    """Return the covariance of what follows from the shared numbers, by central differences."""
    step = np.diag(1e-3 * np.sqrt(np.diag(covariance)))
    slopes = np.array([(derived_at(one) - derived_at(-one)) / (2.0 * one.sum()) for one in step]).T
    return np.asarray(slopes @ covariance @ slopes.T)


def _larger(parts: Floats, formal: Floats) -> Floats:
    """Return the covariance by parts left out, with no less variance than another way of finding it has.

    What the motion leaves open stays at the prior whichever part is left out; only the posterior knows its error.
    """
    short = np.fmax(np.diag(formal) - np.nan_to_num(np.diag(parts)), 0.0)
    return np.asarray(np.where(np.isfinite(parts), parts, 0.0) + np.diag(short))
