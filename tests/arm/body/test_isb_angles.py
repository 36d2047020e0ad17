"""Angles of the ISB against the presets' joints, whose axes point where anatomy has them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from arm.body.isb_angles import isb_angles
from arm.body.limbs import BODY, MEAN_PERSON
from arm.body.whole_body import body_landmarks, body_map, human_body
from arm.kinematics import axis_frames
from arm.model import Marker


@pytest.fixture(scope="module")
def person():
    arm = human_body(replace(MEAN_PERSON, preset=BODY))
    places = body_landmarks(arm)
    markers = tuple(
        Marker(f"M{k}", link + 1, tuple(at.tolist()), None, name)
        for k, (name, (link, at)) in enumerate(places.items())
    )
    return replace(arm, markers=markers)


def turned(person, joint, angle):
    """Return how all ISB angles change as one joint goes from zero to an angle in small steps, by name [rad]."""
    q = np.zeros((21, person.n_joint))
    q[:, body_map().joints.index(joint)] = np.linspace(0.0, angle, 21)
    found = isb_angles(person, q)
    return dict(zip(found.names, found.values[-1] - found.values[0], strict=True))


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("joint", "angle", "sign"),
    [
        ("hip_flexion", "hip_{}_flexion", 1),
        ("hip_abduction", "hip_{}_adduction", -1),
        ("hip_rotation", "hip_{}_internal_rotation", 1),
        ("knee", "knee_{}_flexion", 1),
        ("ankle", "ankle_{}_dorsiflexion", 1),
        ("subtalar", "ankle_{}_inversion", 1),
        ("elbow", "elbow_{}_flexion", 1),
        ("forearm", "elbow_{}_pronation", 1),
        ("radial", "wrist_{}_ulnar_deviation", -1),
    ],
)
def test_a_joint_of_the_preset_is_the_angle_of_its_name_at_either_side(person, side, joint, angle, sign):
    changed = turned(person, f"{joint}_{side}", 0.3)
    name = f"isb_{angle.format(side)}"
    assert changed[name] == pytest.approx(sign * 0.3, abs=0.03)
    others = {k: v for k, v in changed.items() if side not in k or k.split("_")[1] != name.split("_")[1]}
    np.testing.assert_allclose(list(others.values()), 0.0, atol=1e-9)


def test_an_arm_raised_to_the_side_is_elevated_in_the_plane_of_abduction(person):
    q = np.zeros((1, person.n_joint))
    q[:, body_map().joints.index("shoulder_abduction_right")] = 1.2
    found = isb_angles(person, q)
    values = dict(zip(found.names, found.values[0], strict=True))
    assert values["isb_shoulder_right_elevation"] == pytest.approx(-1.2, abs=0.1)
    assert values["isb_shoulder_right_plane"] == pytest.approx(0.0, abs=0.15)
    q[:] = 0.0
    q[:, body_map().joints.index("shoulder_flexion_right")] = 1.2
    found = isb_angles(person, q)
    values = dict(zip(found.names, found.values[0], strict=True))
    assert values["isb_shoulder_right_plane"] == pytest.approx(np.pi / 2.0, abs=0.15)


@given(seed=st.integers(0, 10**6))
@settings(max_examples=15)
def test_the_three_angles_give_the_knees_rotation_back(person, seed):
    """By scipy's own composition, against frames of thigh and shank that no turn has touched."""
    q = np.random.default_rng(seed).uniform(-0.6, 0.6, (2, person.n_joint))
    q[0] = 0.0
    found = isb_angles(person, q)
    values = dict(zip(found.names, found.values.T, strict=True))
    knee = [values[f"isb_knee_right_{name}"] for name in ("flexion", "adduction", "internal_rotation")]
    R = Rotation.from_euler("ZXY", np.column_stack([-knee[0], knee[1], knee[2]])).as_matrix()
    parts = body_map().parts
    thigh, shank = (axis_frames(person, q)[:, parts[f"{s}_right"].link, :3, :3] for s in ("thigh", "shank"))
    relative = np.einsum("nji,njk->nik", thigh, shank)
    # the anatomical frames are fixed in their links: R = A^T relative B, so traces of R R0^T agree up to A alone
    turned = [Rotation.from_matrix(x[1] @ x[0].T).magnitude() for x in (R, relative)]
    assert turned[0] == pytest.approx(turned[1], abs=1e-9)


def test_what_a_joint_lacks_is_said(person):
    less = replace(person, markers=tuple(m for m in person.markers if m.landmark != "medial_malleolus_left"))
    found = isb_angles(less, np.zeros((1, person.n_joint)))
    assert found.missing == {"knee_left": "medial_malleolus_left", "ankle_left": "medial_malleolus_left"}
    assert not any(name.startswith(("isb_knee_left", "isb_ankle_left")) for name in found.names)


def test_a_robot_has_none(person):
    found = isb_angles(replace(person, name="robot"), np.zeros((3, person.n_joint)))
    assert found.names == () and found.values.shape == (3, 0)
