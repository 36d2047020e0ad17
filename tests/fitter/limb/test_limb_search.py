"""When a search of a limb ends, and what it hands over."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.limb.bundle import cost_of, fit_bundle
from fitter.limb.limb_search import Search, polished, search_limb
from tests.fitter.limb.simulated_task import simulated_task


def test_a_search_says_what_it_took_and_a_polish_costs_less():
    known, ticks = simulated_task(), iter(np.arange(100.0))
    told: list[int] = []
    search = Search(population=12, generations=6, frames=9)
    found = search_limb(known.task, known.markers, 0, search, told.append, lambda: float(next(ticks)))
    assert (found.frames, found.population, found.seconds) == (9, 12, 1.0)
    assert told == list(range(1, 7)) and found.bundle.iterations == 6 and not found.bundle.converged
    assert found.bundle.q.shape == known.q.shape
    assert set(found.bundle.markers.std.tolist()) != {0.0}
    after = polished(known.task, found, lambda: float(next(ticks)))
    same = replace(found.bundle.markers, std=after.bundle.markers.std)
    alone = cost_of(known.task, found.bundle.geometry, same, found.bundle.q)
    assert cost_of(known.task, after.bundle.geometry, after.bundle.markers, after.bundle.q) < alone
    assert after.seconds == found.seconds + 1.0


def test_a_search_in_a_point_ends_at_once():
    known = simulated_task()
    fit = fit_bundle(known.task, known.geometry, known.markers, known.q)
    point = replace(known.task, prior=replace(known.task.prior, geometry=fit.geometry))
    none = replace(point.free, what=point.free.what[:0], names=(), std=point.free.std[:0])
    n_free = len(known.task.free.std)
    prior = replace(point.prior, information=point.prior.information[n_free:])
    found = search_limb(replace(point, free=none, prior=prior), known.markers, 0, Search(population=10))
    assert found.bundle.converged and found.bundle.iterations < 40
    np.testing.assert_array_equal(found.bundle.geometry.numbers, fit.geometry.numbers)
    assert found.bundle.markers.place == pytest.approx(fit.markers.place, abs=0.02)
