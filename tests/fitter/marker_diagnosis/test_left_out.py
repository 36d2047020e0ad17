"""Errors of a marker that is left out, against normal equations without it."""

import numpy as np
import pytest

from arm.marker_kinematics import joint_slopes, link_frames, slopes_room
from fitter.limb.inverse_kinematics import follow, link_poses, predicted
from fitter.limb.normal_equations import t_weight
from fitter.marker_diagnosis.left_out import is_seen, left_out
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    truth = simulated_task(n=4)
    chain = truth.markers.chain(truth.geometry)
    y = truth.task.frames.y.copy()
    y[1, 2] = np.nan
    frames = truth.task.frames._replace(y=y)
    q = follow(chain, frames, truth.markers.std, truth.task.angles, 0, near=truth.q)
    return chain, frames, truth.markers.std, truth.task.angles, q


def slopes(chain, frames, q, k):
    room = slopes_room(q.shape[1], 0)
    link_frames(chain, frames.R[k], frames.p[k], q[k], room)
    y, J = predicted(chain, frames, q)[k], []
    for m in range(len(y)):
        room.by_q[:] = 0.0
        joint_slopes(chain, room, m, y[m])
        J.append(room.by_q.copy())
    return np.array(J), frames.y[k] - y


@pytest.mark.parametrize("k", [0, 1])
def test_errors_are_those_of_one_step_without_the_marker(known, k):
    chain, frames, std, prior, q = known
    found = left_out(chain, frames, std, prior, q)
    J, r = slopes(chain, frames, q, k)
    seen = np.isfinite(r[:, 0])
    w = np.array([t_weight(float(x @ x), s**2) if ok else 0.0 for x, s, ok in zip(r, std, seen, strict=True)])
    for m in np.flatnonzero(seen):
        others = [j for j in np.flatnonzero(seen) if j != m]
        A = np.diag(prior.information) + sum(w[j] * J[j].T @ J[j] for j in others)
        # all together are at their minimum, so the others alone pull by what the marker pulled against
        step = np.linalg.solve(A, -w[m] * J[m].T @ r[m])
        off = r[m] - J[m] @ step
        np.testing.assert_allclose(found.axes[k, m] @ found.error[k, m], off, rtol=1e-4, atol=1e-8)
        covariance = J[m] @ np.linalg.solve(A, J[m].T) + std[m] ** 2 * np.eye(3)
        R = found.axes[k, m]
        np.testing.assert_allclose(R @ found.information[k, m] @ R.T @ covariance, np.eye(3), atol=1e-4)
        np.testing.assert_allclose(found.place[k, m], frames.y[k, m] - off, atol=1e-7)


def test_axes_are_those_of_the_markers_link(known):
    chain, frames, std, prior, q = known
    found = left_out(chain, frames, std, prior, q)
    R, _ = link_poses(chain, frames, q)
    np.testing.assert_allclose(found.axes, R[:, chain.link], atol=1e-12)


def test_what_is_not_seen_has_a_place_and_no_error(known):
    chain, frames, std, prior, q = known
    found = left_out(chain, frames, std, prior, q)
    assert np.isnan(found.error[1, 2]).all() and not found.information[1, 2].any()
    np.testing.assert_allclose(found.place[1, 2], predicted(chain, frames, q)[1, 2], atol=1e-12)
    seen = is_seen(frames)
    assert not seen[1, 2] and seen.sum() == seen.size - 1
    assert np.isfinite(found.error[seen]).all()
