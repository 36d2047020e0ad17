"""The cost without places and angles, against numpy and against places and angles nearby."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.limb.inverse_kinematics import follow, predicted
from fitter.limb.marker_observations import FREEDOM
from fitter.limb.projected_cost import projected_cost
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    return simulated_task()


def projected(known, place, q, steps):
    task = known.task
    chain = replace(known.markers, place=place.copy()).chain(known.geometry)
    q = q.copy()
    n_free = len(task.free.std)
    cost = projected_cost(
        chain, task.frames, task.share, q, known.markers.std**2, task.angles, task.prior.place,
        task.prior.information[n_free:], steps,
    )  # fmt: skip
    return cost, chain.place, q


def written_out(known, place, q):
    task, n_free = known.task, len(known.task.free.std)
    y = predicted(replace(known.markers, place=place).chain(known.geometry), task.frames, q)
    squares = np.sum((task.frames.y - y) ** 2, axis=2) / (FREEDOM * known.markers.std**2)
    own = (FREEDOM + 3.0) * np.nansum(np.log1p(squares), axis=1)
    own += (q - task.angles.mean) ** 2 @ task.angles.information
    return task.share @ own + (place - task.prior.place).ravel() ** 2 @ task.prior.information[n_free:]


def test_the_cost_is_the_objective_written_out(known):
    cost, place, q = projected(known, known.markers.place, known.q, (0, 3))
    assert cost == pytest.approx(written_out(known, place, q), rel=1e-9)
    assert cost < written_out(known, known.markers.place, known.q)


def test_no_places_or_angles_nearby_cost_less(known):
    cost, place, q = projected(known, known.markers.place, known.q, (0, 30))
    rng = np.random.default_rng(0)
    for size in (1e-4, 1e-3):
        turned = q.copy()
        turned[:, 6:] += size * rng.standard_normal((len(q), q.shape[1] - 6))
        assert written_out(known, place + size * rng.standard_normal(place.shape), turned) > cost


def test_it_does_not_matter_from_where_places_begin(known):
    cost, place, _ = projected(known, known.markers.place, known.q, (0, 40))
    begin = known.markers.place + 0.03 * np.random.default_rng(1).standard_normal(place.shape)
    chain = replace(known.markers, place=begin).chain(known.geometry)
    q = follow(chain, known.task.frames, known.markers.std, known.task.angles, 0)
    other, there, _ = projected(known, begin, q, (0, 60))
    assert other == pytest.approx(cost, abs=0.01)
    np.testing.assert_allclose(there, place, atol=1e-3)
