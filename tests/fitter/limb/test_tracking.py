"""Tracking of a known limb: angles, the base's pose, gaps, and what is said of the error."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.kinematics import axis_frames
from arm.model import Base, Marker
from fitter.limb.tracking import marked_arm, track_limb
from limbcal.errors import ConfigError, DataError
from tests.fitter.limb.simulated_person import person, with_gaps


def with_markers(truth):
    """Return the true arm with its markers where they are, as a calibration would write it."""
    first, R, p = truth.recordings[0].positions[0], truth.R[0][0], truth.p[0][0]
    frames = axis_frames(truth.arm, truth.q[0][:1])[0]
    in_frame_0 = (first - p) @ R - truth.base_p
    markers = []
    for name, x in zip(truth.recordings[0].names, in_frame_0, strict=True):
        joint = 0 if name.startswith("B") else _link_of(name)
        at = x if joint == 0 else frames[joint - 1, :3, :3].T @ (x - frames[joint - 1, :3, 3])
        markers.append(Marker(name, joint, tuple(at.tolist()), 0.004))
    base = Base(tuple(truth.base_p.tolist()), (0.0, 0.0, 0.0), "scapula_right")
    return replace(truth.arm, markers=tuple(markers), base=base)


def _link_of(name):
    if name.startswith(("upper", "lateral", "medial")):
        return 3
    return 5 if name.startswith(("forearm", "radial", "ulnar")) else 7


@pytest.fixture(scope="module")
def tracked():
    truth = person(n=400, noise_m=1e-3, seed=5)
    gappy = with_gaps(truth.recordings[0], np.random.default_rng(1))
    (found,) = track_limb(with_markers(truth), [gappy])
    return truth, found


def test_angles_are_found_through_gaps(tracked):
    truth, found = tracked
    away = np.degrees(np.abs(found.q - truth.q[0]))
    assert np.median(away) < 0.5
    assert np.quantile(away, 0.95) < 5.0
    assert np.nanmedian(found.distance_m) < 4e-3


def test_errors_hold_what_they_say(tracked):
    truth, found = tracked
    assert np.mean(np.abs(found.q - truth.q[0]) < 3.0 * found.q_std) > 0.95


def test_the_bases_pose_is_that_of_its_segment(tracked):
    truth, found = tracked
    np.testing.assert_allclose(np.linalg.norm(found.base[:, 3:], axis=1), 1.0, atol=1e-9)
    assert np.median(np.linalg.norm(found.base[:, :3] - truth.p[0], axis=1)) < 2e-3
    turned = Rotation.from_quat(found.base[:, [4, 5, 6, 3]]) * Rotation.from_matrix(truth.R[0]).inv()
    assert np.degrees(np.median(turned.magnitude())) < 1.5


def test_an_arm_without_markers_cannot_be_tracked():
    with pytest.raises(ConfigError, match=r"no \[\[marker\]\]"):
        marked_arm(person(n=60).arm)


def test_a_recording_of_something_else_is_an_error():
    truth = person(n=60)
    other = replace(truth.recordings[0], names=tuple(f"x{k}" for k in range(len(truth.recordings[0].names))))
    with pytest.raises(DataError, match="it has none"):
        track_limb(with_markers(truth), [other])
