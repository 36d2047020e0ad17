"""The bundle fit: geometry, marker places and all angles at once, by Levenberg-Marquardt.

Minus twice the log posterior is minimised: markers' errors of a t distribution, whose scale is learnt on the way,
a normal prior of the geometry and of the places about the start, and a weak one of the angles. Angles are
eliminated frame by frame (`normal_equations`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from arm.marker_kinematics import Integers, slopes_room
from arm.model import Floats
from fitter.limb.free_geometry import FreeGeometry, Geometry
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import FREEDOM, AnglePrior, Frames, MarkerModel, swayed
from fitter.limb.normal_equations import bundle_cost, eliminate

#: Iterations at the most, and the relative gain below which they end.
_MOST_ITERATIONS, _CONVERGED = 80, 1e-6
#: The scale is sought between these [m]: what skin makes of markers at the least, whatever the others of a cluster
#: say that is a plate of its own, and at its worst (Leardini et al. 2005).
LEAST_STD_M, _MOST_STD_M = 0.008, 0.025
#: Shares of a step that are tried, and the damping beyond which there is none left.
_SHORTENED, _MOST_DAMPING = (1.0, 0.3, 0.1), 1e4
#: Iterations after which scales are learnt anew.
_RESCALED = (2, 5, 9, 14, 20)


@dataclass(frozen=True)
class Prior:
    """What is known of the shared numbers beforehand: the start, and how well it is known.

    Attributes
    ----------
    geometry : Geometry
    place : (m, 3) [m]
    information : (n_free + 3 m,)
        One over the variance of each.
    """

    geometry: Geometry
    place: Floats
    information: Floats


@dataclass(frozen=True)
class Bundle:
    """What a bundle fit found.

    Attributes
    ----------
    geometry : Geometry
    markers : MarkerModel
    q : (n_frame, n_joint)
    S, b : (n_part, n_shared, n_shared), (n_part, n_shared)
        Normal equations at the end, part by part, without the prior.
    converged : bool
    iterations : int
    """

    geometry: Geometry
    markers: MarkerModel
    q: Floats
    S: Floats
    b: Floats
    converged: bool
    iterations: int


@dataclass(frozen=True)
class Task:
    """What a bundle fit is given.

    Attributes
    ----------
    free : FreeGeometry
    frames : Frames
    share : (n_frame,)
        How much each frame counts: skin that moves coherently has less information than as many independent
        errors.
    part : (n_frame,) int64
        For the normal equations at the end.
    prior : Prior
    angles : AnglePrior
    """

    free: FreeGeometry
    frames: Frames
    share: Floats
    part: Integers
    prior: Prior
    angles: AnglePrior

    def rows(self, which: Integers) -> "Task":
        """Return the task on some of the frames."""
        return replace(self, frames=self.frames.rows(which), share=self.share[which], part=self.part[which])


def shared_away(task: Task, geometry: Geometry, place: Floats) -> Floats:
    """Return the shared numbers less those of the prior, (n_shared,)."""
    moved = (place - task.prior.place).ravel()
    return np.concatenate([geometry.away(task.free, task.prior.geometry), moved])


def cost_of(task: Task, geometry: Geometry, markers: MarkerModel, q: Floats) -> float:
    """Return minus twice the log posterior, up to a constant that depends on the markers' scales only."""
    chain, room = markers.chain(geometry), slopes_room(q.shape[1], len(task.free.std))
    data = bundle_cost(chain, task.frames, q, markers.std**2, task.angles, task.share, room)
    return data + float(task.prior.information @ shared_away(task, geometry, markers.place) ** 2)


def fit_bundle(
    task: Task,
    geometry: Geometry,
    markers: MarkerModel,
    q: Floats,
    progress: Callable[[int], None] | None = None,
    most_iterations: int = _MOST_ITERATIONS,
    scales_known: bool = False,
) -> Bundle:
    """Fit geometry, marker places and angles from a start.

    Parameters
    ----------
    task : Task
    geometry : Geometry
    markers : MarkerModel
    q : (n_frame, n_joint)
    progress : callable, optional
        Called with the iteration.
    most_iterations : int
    scales_known : bool
        Keep the markers' scales.
    """
    free, frames, what = task.free, task.frames, swayed(task.free.what, markers.sway)
    n, n_free, m = q.shape[1], len(task.free.std), len(markers.names)
    n_shared, n_part = n_free + 3 * m, int(task.part.max(initial=0)) + 1
    room = slopes_room(n, n_free)
    gain, shift = np.empty((len(q), n, n_shared)), np.empty((len(q), n))
    S, b = np.empty((n_part, n_shared, n_shared)), np.empty((n_part, n_shared))
    damping, converged, iteration = 1e-3, False, 0
    pending = [] if scales_known else list(_RESCALED)

    now = cost_of(task, geometry, markers, q)
    for iteration in range(1, most_iterations + 1):
        if progress is not None:
            progress(iteration)
        chain, variance = markers.chain(geometry), markers.std**2
        eliminate(
            chain, frames, q, variance, task.angles, task.share, what, 1e-2 * damping, task.part, room,
            gain, shift, S, b,
        )  # fmt: skip
        H = S.sum(axis=0) + np.diag(task.prior.information)
        h = b.sum(axis=0) - task.prior.information * shared_away(task, geometry, markers.place)
        step = np.linalg.solve(H + damping * np.diag(np.diag(H)), h)
        turn, before, better = shift - gain @ step, now, False
        for part in _SHORTENED:
            moved = geometry.moved(free, part * step[:n_free])
            placed = replace(markers, place=markers.place + part * step[n_free:].reshape(m, 3))
            found = cost_of(task, moved, placed, q + part * turn)
            better = found < now
            if better:
                geometry, markers, q, now = moved, placed, q + part * turn, found
                break
        damping = max(0.2 * damping, 1e-9) if better else 30.0 * damping
        if not better and damping < _MOST_DAMPING:
            continue
        still = not better or before - now < _CONVERGED * abs(now)
        if still and not pending:
            converged = True
            break
        if pending and (still or iteration >= pending[0]):
            pending.pop(0)
            markers = rescaled(geometry, markers, frames, q)
            now, damping = cost_of(task, geometry, markers, q), 1e-3
    eliminate(
        markers.chain(geometry), frames, q, markers.std**2, task.angles, task.share, what, 0.0, task.part,
        room, gain, shift, S, b,
    )  # fmt: skip
    return Bundle(geometry, markers, q, S, b, converged, iteration)


def rescaled(geometry: Geometry, markers: MarkerModel, frames: Frames, q: Floats) -> MarkerModel:
    """Return the markers with the scale of the t distribution as the residuals have it (one step of EM).

    One scale for all: were each marker to learn its own, the chain would run through those it began nearest to.
    """
    std = np.sqrt(_variances(geometry, markers, frames, q)[0])
    return replace(markers, std=np.full(len(markers.std), np.clip(std, LEAST_STD_M, _MOST_STD_M)))


def wander(bundle: Bundle, frames: Frames) -> Floats:
    """Return how far each marker wanders along an axis, (m,) [m]: the scale of its own t distribution."""
    own = np.sqrt(_variances(bundle.geometry, bundle.markers, frames, bundle.q)[1])
    return np.clip(np.where(np.isfinite(own), own, bundle.markers.std), 1e-3, _MOST_STD_M)


def _variances(geometry: Geometry, markers: MarkerModel, frames: Frames, q: Floats) -> tuple[float, Floats]:
    """Return the variance of all markers together and of each, (m,) [m²]."""
    squares = np.sum((frames.y - predicted(markers.chain(geometry), frames, q)) ** 2, axis=2)
    seen = np.isfinite(squares)
    filled = np.nan_to_num(squares)
    weight = np.where(seen, (FREEDOM + 3.0) / (FREEDOM + filled / markers.std**2), 0.0)
    total, count = np.sum(weight * filled, axis=0), 3 * seen.sum(axis=0)
    return float(total.sum() / max(count.sum(), 1)), np.where(count > 0, total / np.maximum(count, 1), np.nan)
