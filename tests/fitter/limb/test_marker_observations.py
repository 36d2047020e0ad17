"""The base's sway before a limb's joints, and what is known of it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.marker_kinematics import ALPHA, BASE_POSITION, BASE_ROTATION
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import (
    SWAY,
    AnglePrior,
    base_anywhere,
    base_follows,
    base_sways,
    swayed,
    with_base,
)
from tests.fitter.limb.simulated_task import simulated_task


@pytest.fixture(scope="module")
def known():
    return simulated_task(n=3)


@pytest.fixture
def prior():
    return AnglePrior(np.arange(8.0), np.arange(1.0, 9.0))


def test_sway_slides_along_and_turns_about_frame_0s_axes(known):
    """By three shifts, then turns about x, y and z that the shifts carry along."""
    frames, q = known.task.frames, known.q.copy()
    still = predicted(known.markers.chain(known.geometry), frames, q)
    q[:, :3] = [0.01, -0.02, 0.03]
    moved = predicted(known.markers.chain(known.geometry), frames, q)
    np.testing.assert_allclose(
        np.sort(np.abs(moved - still), axis=2), np.broadcast_to([0.01, 0.02, 0.03], still.shape), atol=1e-12
    )
    axes = known.geometry.base_R
    for i in range(3):
        q = known.q.copy()
        q[:, i] = 0.05
        slid = predicted(known.markers.chain(known.geometry), frames, q) - still
        q = known.q.copy()
        q[:, 3 + i] = 0.3
        turned = predicted(known.markers.chain(known.geometry), frames, q)
        along = slid[0, 0] / np.linalg.norm(slid[0, 0])
        assert np.abs(axes.T @ along).max() == pytest.approx(1.0)
        origin = known.geometry.base_p + frames.p[:, None]
        expected = (still - origin) @ Rotation.from_rotvec(0.3 * along).as_matrix().T + origin
        np.testing.assert_allclose(turned, expected, atol=1e-12)


def test_free_numbers_of_joints_move_behind_the_sway():
    what = np.array([[ALPHA, 2], [BASE_POSITION, 1], [BASE_ROTATION, 0]])
    assert swayed(what, SWAY).tolist() == [[ALPHA, 2 + SWAY], [BASE_POSITION, 1], [BASE_ROTATION, 0]]
    assert what[0, 1] == 2


def stds(prior):
    return prior.information**-0.5


def test_a_base_that_sways_shifts_and_does_not_turn(prior):
    found = base_sways(prior, 0.02)
    assert stds(found)[:SWAY] == pytest.approx([0.02] * 3 + [1e-6] * 3)
    assert stds(base_sways(prior, 0.0))[:3] == pytest.approx([1e-6] * 3)
    np.testing.assert_array_equal(found.mean, prior.mean)
    np.testing.assert_array_equal(found.information[SWAY:], prior.information[SWAY:])


@pytest.mark.parametrize(
    ("n_marker", "shift", "turn"), [(0, 1e-6, 1e-6), (1, 0.05, 1e-6), (2, 0.05, 1e-6), (3, 0.05, 0.3)]
)
def test_a_base_follows_as_far_as_its_markers_tell(prior, n_marker, shift, turn):
    assert stds(base_follows(prior, n_marker))[:SWAY] == pytest.approx([shift] * 3 + [turn] * 3)


def test_markers_of_the_base_ride_on_frame_0(known):
    model = with_base(known.markers, ("B1", "B2"), np.array([[0.1, 0.0, 0.0], [0.0, 0.2, 0.0]]), 0.003)
    assert model.names[-2:] == ("B1", "B2") and model.std[-2:].tolist() == [0.003, 0.003]
    frames = known.task.frames
    wide = frames._replace(y=np.zeros((3, len(model.names), 3)))
    y = predicted(model.chain(known.geometry), wide, known.q)
    expected = known.geometry.base_R @ [0.1, 0.0, 0.0] + known.geometry.base_p + frames.p
    np.testing.assert_allclose(y[:, -2], expected, atol=1e-12)


def test_rows_of_frames_go_together(known):
    found = known.task.frames.rows(np.array([2, 0]))
    assert found.t.tolist() == [2.0, 0.0] and found.y.shape[0] == found.R.shape[0] == found.p.shape[0] == 2
    np.testing.assert_array_equal(found.p[1], known.task.frames.p[0])


def test_a_base_that_may_be_anywhere_turns_no_more_than_before(prior):
    found = base_anywhere(prior)
    assert stds(found)[:3] == pytest.approx([10.0] * 3)
    np.testing.assert_array_equal(found.information[3:], prior.information[3:])
    np.testing.assert_array_equal(found.mean, prior.mean)
