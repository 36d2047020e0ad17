"""Normal equations of a frame against those marker by marker, and against slopes of the cost."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from arm.marker_kinematics import joint_slopes, link_frames, marker_at, marker_chain, slopes_room
from fitter.limb.frame_equations import frame_equations
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import AnglePrior, Frames
from fitter.limb.normal_equations import t_cost, t_weight
from tests.fitter.limb.simulated_task import simulated_task

_FAR_M = 5.0  # across a laboratory


@pytest.fixture(scope="module")
def known():
    return simulated_task(n=6)


@pytest.fixture(scope="module")
def chain(known):
    return known.markers.chain(known.geometry)


def test_the_cost_is_that_of_markers_and_prior(known, chain):
    frames, prior, q = known.task.frames, known.task.angles, known.q[2] + 0.05
    y = frames.y.copy()
    y[2, 4] = np.nan
    one = frames._replace(y=y)
    off = predicted(chain, one, np.tile(q, (len(y), 1)))[2] - y[2]
    variance = known.markers.std**2
    expected = sum(
        t_cost(float(x @ x), v) for x, v in zip(off, variance, strict=True) if np.isfinite(x).all()
    ) + float(prior.information @ (q - prior.mean) ** 2)
    room = slopes_room(len(q), 0)
    A, a = np.empty((len(q), len(q))), np.empty(len(q))
    assert frame_equations(chain, one, 2, variance, prior, q, room, A, a) == pytest.approx(expected, rel=1e-9)
    np.testing.assert_array_equal(A, A.T)
    slope, spare = np.empty(len(q)), (A.copy(), a.copy())
    for i in range(len(q)):
        step = np.zeros(len(q))
        step[i] = 1e-6 / np.sqrt(max(prior.information[i], 1.0))
        costs = [
            frame_equations(chain, one, 2, variance, prior, q + way * step, room, *spare) for way in (1.0, -1.0)
        ]
        slope[i] = (costs[0] - costs[1]) / (2.0 * step[i])
    np.testing.assert_allclose(-2.0 * a, slope, rtol=2e-4, atol=2e-4 * np.abs(slope).max())


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_links_summed_are_markers_one_by_one(seed):
    """On trees of joints that turn or slide."""
    rng = np.random.default_rng(seed)
    n, n_marker = 6, 7
    chain = marker_chain(
        rng.random(n) < 0.7, rng.normal(size=(n, 5)), rng.integers(0, n, n_marker),
        rng.normal(size=(n_marker, 3)), Rotation.random(rng=rng).as_matrix(), rng.normal(size=3),
        np.array([rng.integers(-1, i) for i in range(n)]), rng.normal(size=(n, 4)),
    )  # fmt: skip
    q, room, y = rng.normal(size=n), slopes_room(n, 0), np.empty(3)
    R, p = Rotation.random(1, rng=rng).as_matrix(), _FAR_M * rng.normal(size=(1, 3))
    frames = Frames(np.empty((1, n_marker, 3)), R, p, np.zeros(1, dtype=np.int64), np.zeros(1))
    there = predicted(chain, frames, q[None])
    frames = frames._replace(y=there + 0.02 * rng.normal(size=there.shape))
    frames.y[0, 2] = np.nan
    prior = AnglePrior(rng.normal(size=n), rng.uniform(0.0, 10.0, n))
    variance = rng.uniform(1e-5, 1e-3, n_marker)
    A, a = np.empty((n, n)), np.empty(n)
    frame_equations(chain, frames, 0, variance, prior, q, room, A, a)
    expected, pull = np.diag(prior.information), prior.information * (prior.mean - q)
    link_frames(chain, R[0], p[0], q, room)
    for m in range(n_marker):
        if m != 2:
            marker_at(chain, room, m, y)
            joint_slopes(chain, room, m, y)
            r, J = frames.y[0, m] - y, room.by_q
            w = t_weight(float(r @ r), variance[m])
            expected, pull = expected + w * J.T @ J, pull + w * J.T @ r
    np.testing.assert_allclose(A, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    np.testing.assert_allclose(a, pull, rtol=1e-9, atol=1e-9 * np.abs(pull).max())
