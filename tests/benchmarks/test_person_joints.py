"""Joints that are held, and all others as they were."""

import numpy as np

from arm.body.whole_body import body_map
from benchmarks.person_joints import SHANKS, with_std
from fitter.limb.marker_observations import AnglePrior


def test_only_the_joints_named_have_another_prior():
    joints = body_map().joints
    prior = AnglePrior(np.zeros(len(joints)), np.ones(len(joints)))
    held = with_std(prior, SHANKS, 0.1, 0.3)
    for i, name in enumerate(joints):
        mean, information = (0.3, 100.0) if name in ("shank_right", "shank_left") else (0.0, 1.0)
        np.testing.assert_allclose([held.mean[i], held.information[i]], [mean, information])
