"""The incremental genetic algorithm on a limb: what holds in every generation."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.limb.bundle import cost_of
from fitter.limb.genetic_limb import IncrementalLimb
from fitter.limb.search_box import SearchBox, search_box
from tests.fitter.limb.simulated_task import simulated_task

_POPULATION = 20


@pytest.fixture(scope="module")
def known():
    return simulated_task()


def searched(known, places_seed, generations=4, **changed):
    task = replace(known.task, **changed)
    unknown = np.random.default_rng(places_seed).normal(size=known.markers.place.shape)
    box = search_box(task.free, task.prior.geometry)
    search = IncrementalLimb(task, replace(known.markers, place=unknown), box, 3, _POPULATION)
    search.add(np.arange(6))
    costs = [search.generation() for _ in range(generations)]
    return search, costs


def test_the_best_never_gets_worse_and_the_seed_decides_all(known):
    search, costs = searched(known, 0, 8)
    assert np.all(np.diff(costs) <= 0.0) and costs[-1] < 0.5 * costs[0]
    _, again = searched(known, 0, 8)
    assert again == costs


def test_places_that_are_handed_over_are_not_looked_at(known):
    assert searched(known, 0)[1] == searched(known, 1)[1]


def test_the_cost_is_the_bundle_fits(known):
    search, _ = searched(known, 0)
    task = known.task.rows(np.arange(6))
    assert search.cost == pytest.approx(cost_of(task, search.geometry, search.markers, search.q), rel=1e-9)


def test_a_batch_stands_for_all_frames_up_to_its_last(known):
    n = len(known.task.frames.t)
    search, _ = searched(known, 0, share=np.full(n, 0.5))
    task = replace(known.task, share=np.full(n, 0.5)).rows(np.arange(6))
    assert search.cost == pytest.approx(cost_of(task, search.geometry, search.markers, search.q), rel=1e-9)
    before = search.q.copy()
    search.add(np.array([9]))
    assert search.q.shape == (7, before.shape[1]) and search.rows.tolist() == [*range(6), 9]
    task = replace(known.task, share=np.full(n, 5.0 / 7.0)).rows(search.rows)
    search.generation()
    assert search.cost == pytest.approx(cost_of(task, search.geometry, search.markers, search.q), rel=1e-9)


def test_near_the_truth_lengths_come_out(known):
    free = known.task.free
    half = np.where([name[0] in "adb" and "alpha" not in name for name in free.names], 0.03, 0.1)
    box = SearchBox(free, known.geometry, -half, half)
    search = IncrementalLimb(known.task, known.markers, box, 1, 40)
    search.add(np.arange(8))
    for _ in range(18):
        search.generation()
    thigh, shank = ((search.geometry.numbers - known.geometry.numbers)[i] for i in ((2, 2), (3, 1)))
    assert abs(thigh) < 6e-3 and abs(shank) < 6e-3
