"""Angles frame by frame, their normal equations and the places of markers, on a leg whose angles are known."""

import numpy as np
import pytest

from arm.kinematics import axis_frames
from arm.marker_kinematics import slopes_room
from fitter.limb.frame_equations import frame_equations
from fitter.limb.inverse_kinematics import follow, link_poses, predicted, solve_frame
from fitter.limb.marker_observations import SWAY
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    return simulated_task(n=6)


@pytest.fixture(scope="module")
def chain(known):
    return known.markers.chain(known.geometry)


def test_links_are_where_the_arms_kinematics_has_them(known, chain):
    R, o = link_poses(chain, known.task.frames, known.q)
    arm = known.arm.with_joints(
        **{
            name: known.geometry.numbers[:, k]
            for k, name in enumerate(("alpha_rad", "a_m", "d_m", "beta_rad", "theta_offset_rad"))
        }
    )
    expected = axis_frames(arm, known.q[:, SWAY:])
    place = expected[..., :3, 3] + known.geometry.base_p + known.task.frames.p[:, None]
    np.testing.assert_allclose(R[:, SWAY:], expected[..., :3, :3], atol=1e-12)
    np.testing.assert_allclose(o[:, SWAY:], place, atol=1e-12)
    y = predicted(chain, known.task.frames, known.q)
    link = known.markers.link
    carried = np.einsum("kmij,mj->kmi", expected[:, link, :3, :3], known.markers.place) + place[:, link]
    np.testing.assert_allclose(y, carried, atol=1e-12)


def test_a_frame_is_solved_where_its_cost_is_flat(known, chain):
    frames, prior, variance = known.task.frames, known.task.angles, known.markers.std**2
    q, n = known.q[1].copy(), known.q.shape[1]
    q[SWAY:] += 0.2
    room = slopes_room(n, 0)
    cost = solve_frame(chain, frames, 1, variance, prior, 60, room, q)
    A, a = np.empty((n, n)), np.empty(n)
    assert cost == pytest.approx(frame_equations(chain, frames, 1, variance, prior, q, room, A, a))
    assert np.abs(np.linalg.solve(A, a)).max() < 1e-4
    np.testing.assert_allclose(q, known.q[1], atol=0.05)


def test_any_posture_is_found_from_none(known, chain):
    """Frames a second apart: neither the first nor the one before is near."""
    found = follow(chain, known.task.frames, known.markers.std, known.task.angles, 0)
    np.testing.assert_allclose(found, known.q, atol=0.06)
    away = found + np.where(np.arange(found.shape[1]) >= SWAY, 0.1, 0.0)
    again = follow(chain, known.task.frames, known.markers.std, known.task.angles, 0, near=away, begin=away)
    np.testing.assert_allclose(again, found, atol=1e-3)
    np.testing.assert_array_equal(away[:, SWAY:], found[:, SWAY:] + 0.1)


def test_another_minimum_is_left_again(known, chain):
    """A slow motion whose frames all begin where a leg turned half about ends in another minimum."""
    n = 120
    t = 0.01 * np.arange(n)
    q = np.tile(known.q[:1], (n, 1))
    q[:, SWAY:] += 0.1 * np.sin(2.0 * np.pi * t[:, None] + np.arange(6.0))
    frames = known.task.frames.rows(np.zeros(n, dtype=np.int64))._replace(t=t)
    frames = frames._replace(y=predicted(chain, frames, q))
    variance, prior, room = known.markers.std**2, known.task.angles, slopes_room(q.shape[1], 0)
    away = q.copy()
    away[:, SWAY:] += [-0.46, -0.32, -2.63, -1.39, 0.55, -0.56]
    stuck = away.copy()
    for k in range(n):
        solve_frame(chain, frames, k, variance, prior, 60, room, stuck[k])
    assert np.mean(np.abs(stuck - q).max(axis=1) > 0.5) > 0.5
    found = follow(chain, frames, known.markers.std, prior, 0, near=away)
    np.testing.assert_allclose(found, q, atol=0.06)


def test_an_unseen_frame_is_where_the_prior_has_it(known, chain):
    y = known.task.frames.y.copy()
    y[3] = np.nan
    found = follow(chain, known.task.frames._replace(y=y), known.markers.std, known.task.angles, 0)
    np.testing.assert_allclose(found[3], known.task.angles.mean, atol=1e-6)
    np.testing.assert_allclose(found[4], known.q[4], atol=0.06)
