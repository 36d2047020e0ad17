"""A fit that ends where the prior hardly lets it begins once more: at the prior, about the base that it found.

A base that little is known of, such as one marker, begins decimetres off. While it goes to where the limb has it,
axes and marker places make up for it, and may end in another minimum. From the base that was found they need not.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fitter.limb.bundle import Bundle, Task, cost_of, fit_bundle
from fitter.limb.inverse_kinematics import follow

#: A number of the geometry that is farther from its prior, in standard deviations, makes a fit doubtful: of twenty
#: numbers one is so by chance once in twenty fits.
_DOUBTFUL = 3.0


def is_doubtful(task: Task, bundle: Bundle) -> bool:
    """Return whether a fit has a number of the geometry where its prior hardly lets it be."""
    away = bundle.geometry.away(task.free, task.prior.geometry)
    return bool((np.abs(away) > _DOUBTFUL * task.free.std).any())


def begun_again(task: Task, bundle: Bundle, seed: int, progress: Callable[[int], None] | None = None) -> Bundle:
    """Return a fit, or the one from a second start where that is likelier.

    Parameters
    ----------
    task : Task
    bundle : Bundle
    seed : int
        Of the postures that angles begin from.
    progress : callable, optional
        Called with the iteration.
    """
    if not is_doubtful(task, bundle):
        return bundle
    found = bundle.geometry
    geometry = replace(task.prior.geometry, base_R=found.base_R, base_p=found.base_p)
    markers = replace(bundle.markers, place=task.prior.place.copy())
    q = follow(markers.chain(geometry), task.frames, markers.std, task.angles, seed)
    other = fit_bundle(task, geometry, markers, q, progress)
    alike = replace(other.markers, std=bundle.markers.std)  # costs are comparable under the same scales
    costs = [cost_of(task, found, bundle.markers, bundle.q), cost_of(task, other.geometry, alike, other.q)]
    return other if costs[1] < costs[0] else bundle
