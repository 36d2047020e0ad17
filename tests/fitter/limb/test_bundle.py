"""The bundle fit on a task whose geometry and marker places are known."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.limb.bundle import cost_of, fit_bundle, rescaled, shared_away, wander
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.normal_equations import t_cost
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    return simulated_task(n=40)


@pytest.fixture(scope="module")
def fitted(known):
    told = []
    markers = replace(known.markers, place=known.task.prior.place)
    bundle = fit_bundle(known.task, known.task.prior.geometry, markers, known.q, told.append)
    return bundle, told


def test_lengths_are_the_true_ones_not_the_priors(known, fitted):
    bundle, told = fitted
    assert bundle.converged and told == list(range(1, bundle.iterations + 1))
    free = known.task.free
    away = bundle.geometry.away(free, known.geometry)
    before = known.task.prior.geometry.away(free, known.geometry)
    at = [free.names.index(name) for name in ("d3", "a4")]
    assert np.all(np.abs(away[at]) < 3e-3) and np.abs(before[at]).max() > 0.01
    y = predicted(bundle.markers.chain(bundle.geometry), known.task.frames, bundle.q)
    assert np.sqrt(np.mean((y - known.task.frames.y) ** 2)) < 1.5e-3


def test_the_answer_is_a_minimum_along_every_shared_number(known, fitted):
    """With the angles free the normal equations have no step left."""
    bundle, _ = fitted
    task = known.task
    away = shared_away(task, bundle.geometry, bundle.markers.place)
    information = task.prior.information
    step = np.linalg.solve(bundle.S.sum(axis=0) + np.diag(information), bundle.b.sum(axis=0) - information * away)
    assert np.abs(step * np.sqrt(information)).max() < 0.05


def test_parts_add_up_to_the_whole(known, fitted):
    bundle, _ = fitted
    parts = (np.arange(len(known.q)) % 3).astype(np.int64)
    task = replace(known.task, part=parts)
    again = fit_bundle(task, bundle.geometry, bundle.markers, bundle.q, most_iterations=1, scales_known=True)
    assert again.S.shape[0] == 3
    own = fit_bundle(known.task, bundle.geometry, bundle.markers, bundle.q, most_iterations=1, scales_known=True)
    np.testing.assert_allclose(again.S.sum(axis=0), own.S[0], rtol=1e-9, atol=1e-6 * np.abs(own.S).max())


def test_the_cost_is_that_of_markers_angles_and_prior(known):
    task, geometry = known.task, known.task.prior.geometry
    task = replace(task, share=np.linspace(0.2, 1.0, len(known.q)))
    markers = known.markers
    off = predicted(markers.chain(geometry), task.frames, known.q) - task.frames.y
    expected = 0.0
    for k in range(len(off)):
        own = sum(t_cost(float(x @ x), s**2) for x, s in zip(off[k], markers.std, strict=True))
        own += float(task.angles.information @ (known.q[k] - task.angles.mean) ** 2)
        expected += task.share[k] * own
    moved = (markers.place - task.prior.place).ravel()
    n = len(moved)
    expected += float(task.prior.information[-n:] @ moved**2)
    assert cost_of(task, geometry, markers, known.q) == pytest.approx(expected, rel=1e-9)


def test_scales_are_the_spread_of_a_marker_about_the_chain(known):
    rng = np.random.default_rng(3)
    y = predicted(known.markers.chain(known.geometry), known.task.frames, known.q)
    spread = np.array([0.004, 0.02])
    noisy = y + rng.normal(size=y.shape) * np.resize(spread, y.shape[1])[:, None]
    noisy[:, 0] = np.nan  # was never seen
    frames = known.task.frames._replace(y=noisy)
    markers = replace(known.markers, std=np.full(y.shape[1], 0.0145))
    found = rescaled(known.geometry, markers, frames, known.q).std
    assert len(set(found.tolist())) == 1 and 0.008 < found[0] < 0.0145
    bundle = replace_bundle(known, markers)
    own = wander(bundle, frames)
    assert own[0] == 0.0145 and np.all(own[3::2] > 2.0 * own[2::2])
    tiny = rescaled(known.geometry, markers, known.task.frames, known.q).std
    assert np.all(tiny == 0.008)


def replace_bundle(known, markers):
    return fit_bundle(known.task, known.geometry, markers, known.q, most_iterations=0, scales_known=True)


def test_rows_are_those_of_every_field(known):
    which = np.array([3, 1])
    task = known.task.rows(which)
    np.testing.assert_array_equal(task.frames.y, known.task.frames.y[which])
    assert task.share.shape == task.part.shape == (2,)
