"""Where the fit of a person begins: lengths by landmarks, frame 0 the laboratory's."""

import numpy as np
import pytest

from fitter.limb.inverse_kinematics import link_poses
from tests.fitter.body.simulated_body import WHERE


def test_the_start_has_the_lengths_of_the_landmarks(person, fit):
    numbers = fit.start.geometry.numbers
    knee = WHERE.centres["knee_left"]
    assert numbers[knee, 1] == pytest.approx(person.lengths_m["shank_left"], abs=1e-3)


def test_the_pelvis_is_where_it_is_in_the_laboratory(person, fit):
    _, o = link_poses(fit.bundle.markers.chain(fit.bundle.geometry), fit.task.frames, fit.bundle.q)
    middle = 0.5 * (o[:, WHERE.centres["hip_right"]] + o[:, WHERE.centres["hip_left"]])
    true = 0.5 * (person.centres_m["hip_right"] + person.centres_m["hip_left"])[fit.rows]
    assert np.median(np.linalg.norm(middle - true, axis=1)) < 0.015
