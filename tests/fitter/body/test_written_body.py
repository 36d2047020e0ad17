"""The person as an arm file: tracked from it, and weighing what the person does."""

import numpy as np
import pytest

from arm.arm_file import format_arm, parse_arm
from arm.body.limbs import BODY
from arm.kinematics import axis_frames
from arm.model import Body
from arm.newton_euler import inverse_dynamics
from benchmarks.simulated_people.body import WHERE
from fitter.body.written_body import calibrated_body
from fitter.limb.tracking import track_limb


@pytest.fixture(scope="module")
def arm(fit):
    return calibrated_body(fit, Body(BODY, 61.0, 1.7, "f"))


def test_it_is_read_back_and_bears_the_persons_weight(arm):
    assert parse_arm(format_arm(arm), "file").n_joint == len(WHERE.joints)
    still = np.zeros((1, len(WHERE.joints)))
    force = inverse_dynamics(arm, still, still, still)[0, :3]
    assert np.linalg.norm(force) == pytest.approx(61.0 * 9.80665, rel=1e-3)
    assert arm.gravity_m_s2 == (0.0, -9.80665, 0.0)


def test_writing_it_leaves_the_fit_alone(fit):
    before = fit.bundle.geometry.numbers.copy()
    calibrated_body(fit, Body(BODY, 61.0, 1.7, "f"))
    np.testing.assert_array_equal(fit.bundle.geometry.numbers, before)


def test_its_motion_has_the_centres_where_they_were(person, arm):
    (tracked,) = track_limb(arm, [person.recording])
    assert tracked.base is None
    assert np.sqrt(np.nanmean(tracked.distance_m**2)) < 2.5e-3
    frames = axis_frames(arm, tracked.q)
    for name in ("knee_right", "ankle_left", "elbow_right"):
        away = np.linalg.norm(frames[:, WHERE.centres[name], :3, 3] - person.centres_m[name], axis=1)
        assert np.median(away) < 0.015
