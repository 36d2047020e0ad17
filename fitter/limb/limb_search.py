"""A limb by the genetic algorithm alone, and polished: batches of frames, and when the search ends."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fitter.limb.bundle import Bundle, Task, fit_bundle
from fitter.limb.frame_choice import thinned
from fitter.limb.genetic_limb import CLOSE, IncrementalLimb
from fitter.limb.inverse_kinematics import follow
from fitter.limb.marker_observations import MarkerModel
from fitter.limb.search_box import HALF_RANGE_RAD, search_box

#: The paper's number of generations (section 5); a search ends before, once its population is one point.
GENERATIONS = 500
#: Frames that the search takes of those of the fit: as many as, at one in `COHERENCE_S`, are independent in 10 s.
SEARCH_FRAMES = 32
#: Frames of the first batch; each next one doubles them.
_FIRST_FRAMES = 8
#: A population is one point when the costs of its better quarter differ by less (a tenth of a standard error).
_ONE_POINT = 0.01 * CLOSE
#: A batch takes at most this fraction of the generations, so that the last one has some.
_BATCH_SHARE = 8
Clock = Callable[[], float]


@dataclass(frozen=True)
class Search:
    """How to search.

    Attributes
    ----------
    population : int, optional
        Default 100, or 8 individuals a free number where that is more.
    generations : int
        At the most.
    frames : int
        Of the fit's, at the most.
    half_range_rad : float
        Of angles, about the preset's.
    """

    population: int | None = None
    generations: int = GENERATIONS
    frames: int = SEARCH_FRAMES
    half_range_rad: float = HALF_RANGE_RAD


@dataclass(frozen=True)
class Found:
    """What one method found.

    Attributes
    ----------
    bundle : Bundle
        Its answer, with the angles of all frames of the task.
    seconds : float
        Of processor time.
    frames, population : int
        That it took; one individual is a start.
    """

    bundle: Bundle
    seconds: float
    frames: int
    population: int = 1


def search_limb(
    task: Task,
    markers: MarkerModel,
    seed: int,
    search: Search,
    progress: Callable[[int], None] | None = None,
    clock: Clock = time.process_time,
) -> Found:
    """Search a limb's geometry and marker places without starting values.

    Parameters
    ----------
    task : Task
        The bundle fit's.
    markers : MarkerModel
        Names, links and the first scale; their places are not looked at.
    seed : int
    search : Search
    progress : callable, optional
        Called after every generation how many are done.
    clock : callable
        Processor time [s].

    Returns
    -------
    Found
        The geometry and places of the search as it left them; angles of all frames by inverse kinematics.
    """
    began = clock()
    box = search_box(task.free, task.prior.geometry, search.half_range_rad)
    ga = IncrementalLimb(task, markers, box, seed, search.population)
    rows = thinned(np.ones(len(task.frames.t), dtype=np.bool_), search.frames)
    ends = [_FIRST_FRAMES << k for k in range(len(rows)) if _FIRST_FRAMES << k < len(rows)] + [len(rows)]
    for begin, end in zip([0, *ends[:-1]], ends, strict=True):
        ga.add(rows[begin:end])
        is_last = end == len(rows)
        most = search.generations if is_last else min(search.generations, _last_of(ga.generations, search))
        while ga.generations < most and not ga.spread < (_ONE_POINT if is_last else CLOSE):
            ga.generation()
            if progress is not None:
                progress(ga.generations)
    q = follow(ga.markers.chain(ga.geometry), task.frames, ga.markers.std, task.angles, seed)
    answer = fit_bundle(task, ga.geometry, ga.markers, q, most_iterations=0)
    answer = replace(answer, converged=ga.spread < _ONE_POINT, iterations=ga.generations)
    return Found(answer, clock() - began, len(rows), ga.population)


def _last_of(generations: int, search: Search) -> int:
    return generations + max(search.generations // _BATCH_SHARE, 1)


def polished(task: Task, found: Found, clock: Clock = time.process_time) -> Found:
    """Return the bundle fit that begins where a search ended."""
    began, own = clock(), found.bundle
    answer = fit_bundle(task, own.geometry, own.markers, own.q)
    return replace(found, bundle=answer, seconds=found.seconds + clock() - began, frames=len(own.q))
