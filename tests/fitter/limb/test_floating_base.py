"""A base that floats by joints of its own."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.limbs import BODY, MEAN_PERSON, limb
from arm.body.whole_body import PELVIS_LINK, body_map, human_body
from fitter.limb.floating_base import floating_angles, floating_joints
from fitter.limb.free_geometry import geometry_of
from fitter.limb.initial_geometry import joint_prior
from fitter.limb.inverse_kinematics import predicted
from fitter.limb.marker_observations import Frames, MarkerModel


@pytest.fixture(scope="module")
def body():
    return human_body(replace(MEAN_PERSON, preset=BODY))


def test_a_body_floats_and_a_limb_does_not(body):
    assert floating_joints(body) == 6
    assert floating_joints(limb(replace(MEAN_PERSON, preset="human-leg-left"))) == 0


@pytest.mark.parametrize(("n_marker", "follows"), [(4, True), (2, False)])
def test_three_markers_on_it_tell_where_it_is_whichever_way_it_turns(body, n_marker, follows):
    rng = np.random.default_rng(0)
    prior = joint_prior(body, body_map().balls, 6)
    place = rng.normal(scale=0.1, size=(n_marker, 3))
    model = MarkerModel(
        tuple("ABCD"[:n_marker]),
        np.full(n_marker, PELVIS_LINK, dtype=np.int64),
        place,
        np.full(n_marker, 0.005),
        0,
    )
    q = np.tile(prior.mean, (5, 1))
    q[:, :6] = [0.4, -1.0, 0.9, 0.0, 0.1, 0.3] + np.outer(np.arange(5), [0.02, 0.0, 0.01, 0.6, 0.02, 0.05])
    frames = Frames(
        np.zeros((5, n_marker, 3)),
        np.tile(np.eye(3), (5, 1, 1)),
        np.zeros((5, 3)),
        np.zeros(5, dtype=np.int64),
        np.arange(5.0),
    )
    geometry = geometry_of(body)
    frames = frames._replace(y=predicted(model.chain(geometry), frames, q))
    found = floating_angles(geometry, model, frames, prior, 0)
    np.testing.assert_array_equal(found[:, 6:], np.tile(prior.mean, (5, 1))[:, 6:])
    near = np.abs(predicted(model.chain(geometry), frames, found) - frames.y).max() < 1e-3
    assert near == follows
