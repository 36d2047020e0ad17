"""A whole person: a tree whose segments weigh what the person does, alike at either side."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.body.limbs import BODY, MEAN_PERSON
from arm.body.whole_body import BRANCHES, body_landmarks, body_map, human_body, limb_of_body
from arm.kinematics import axis_frames
from arm.model import Body
from arm.newton_euler import inverse_dynamics, mass_matrix
from arm.physical_links import is_possible, link_parameters

WHERE = body_map()
MIRROR = np.diag([1.0, -1.0, 1.0])
#: Coordinates that turn or shift to a side, where a mirror image goes the other way.
SIDEWAYS = ("pelvis_left", "pelvis_rotation", "pelvis_obliquity", "lumbar_bending", "lumbar_rotation")


def posed(**positions):
    q = np.zeros((1, len(WHERE.joints)))
    for name, value in positions.items():
        q[0, WHERE.joints.index(name)] = value
    return q


@pytest.fixture(scope="module")
def person():
    return load_arm(BODY)


@pytest.mark.parametrize("sex", ["f", "m"])
def test_the_segments_weigh_what_the_person_does(sex):
    arm = human_body(Body(BODY, 61.0, 1.68, sex))
    assert sum(joint.link.mass_kg for joint in arm.joints) == pytest.approx(61.0, rel=2e-4)
    heavy = {i for i, joint in enumerate(arm.joints) if joint.link.mass_kg}
    assert heavy == {part.link for name, part in WHERE.parts.items() if not name.startswith("scapula")}
    assert all(is_possible(link_parameters(arm.joints[i].link)) for i in heavy)
    assert parse_arm(format_arm(arm), "file") == arm


def test_standing_it_is_as_high_as_a_person(person):
    """Sole to vertex, and the centre of mass at 0.57 of stature (Winter 2009: 0.55 to 0.58)."""
    frames = axis_frames(person, posed())[0]
    sole = frames[WHERE.parts["foot_right"].link, 2, 3] - 0.039 * 1.741
    weights = np.array([joint.link.mass_kg for joint in person.joints])
    coms = np.array([f[:3, :3] @ j.link.com_m + f[:3, 3] for f, j in zip(frames, person.joints, strict=True)])
    centre = weights @ coms / weights.sum() - [0.0, 0.0, sole]
    assert centre[2] / 1.741 == pytest.approx(0.57, abs=0.01)
    assert abs(centre[0]) < 0.01 and abs(centre[1]) < 1e-12
    assert 0.6033 + 0.2429 - sole == pytest.approx(1.741, abs=0.05)


def test_what_carries_the_pelvis_carries_the_person(person):
    """At rest the floating base bears the weight and, with arms and legs hanging, next to no moment."""
    tau = inverse_dynamics(person, posed(), posed(), posed())[0]
    np.testing.assert_allclose(tau[:3], [0.0, 0.0, 73.0 * 9.80665], atol=1e-9)
    assert np.linalg.eigvalsh(mass_matrix(person, posed(knee_right=0.3, elbow_left=0.5))[0])[0] > 0.0


@pytest.mark.parametrize(
    ("positions", "link", "axis", "sign"),
    [
        ({"pelvis_forward": 0.3}, "foot_left", 0, 1), ({"pelvis_left": 0.3}, "hand_left", 1, 1),
        ({"pelvis_up": 0.3}, "thorax", 2, 1), ({"pelvis_rotation": 0.5}, "thigh_right", 0, 1),
        ({"pelvis_obliquity": 0.4}, "thigh_left", 2, 1), ({"pelvis_tilt": 0.4}, "thorax", 0, 1),
        ({"lumbar_flexion": 0.4}, "upper_arm_right", 0, 1), ({"lumbar_bending": 0.4}, "upper_arm_right", 2, -1),
        ({"lumbar_rotation": 0.4}, "upper_arm_right", 0, 1), ({"hip_flexion_right": 0.4}, "shank_right", 0, 1),
        ({"hip_abduction_left": 0.4}, "shank_left", 1, 1), ({"shoulder_flexion_left": 0.4}, "hand_left", 0, 1),
        ({"thoracic_flexion": 0.4}, "scapula_left", 0, 1),
    ],
)  # fmt: skip
def test_joints_move_the_body_as_anatomy_says(person, positions, link, axis, sign):
    k = WHERE.parts[link].link
    after, before = (axis_frames(person, q)[0, k, :3, 3] for q in (posed(**positions), posed()))
    assert sign * (after - before)[axis] > 0.02


def test_left_is_the_mirror_image_of_right(person):
    rng = np.random.default_rng(0)
    q = rng.uniform(-0.6, 0.6, (1, len(WHERE.joints)))
    mirrored = q.copy()
    for i, name in enumerate(WHERE.joints):
        other = name.replace("right", "left") if name.endswith("right") else name.replace("left", "right")
        other = name if name.startswith(("pelvis", "lumbar", "thoracic")) else other
        mirrored[0, WHERE.joints.index(other)] = -q[0, i] if name in SIDEWAYS else q[0, i]
    frames, images = axis_frames(person, q)[0], axis_frames(person, mirrored)[0]
    for segment, part in WHERE.parts.items():
        other = segment.replace("right", "left") if segment.endswith("right") else segment.replace("left", "right")
        ours, theirs = frames[part.link, :3, 3], images[WHERE.parts[other].link, :3, 3]
        np.testing.assert_allclose(theirs, MIRROR @ ours, atol=1e-12)


def test_its_limbs_are_the_limbs_that_hang_there(person):
    q = np.random.default_rng(1).uniform(-0.5, 0.5, (1, len(WHERE.joints)))
    frames = axis_frames(person, q)[0]
    for name in ("leg_left", "arm_right"):
        branch = BRANCHES[name]
        chosen = slice(branch.first, branch.first + len(branch.names))
        own = axis_frames(limb_of_body(MEAN_PERSON, name), q[:, chosen])[0]
        inner = np.linalg.inv(frames[branch.first]) @ frames[chosen]
        np.testing.assert_allclose(inner, np.linalg.inv(own[0]) @ own, atol=1e-12)
        link, place = person.parents[branch.first], np.array(person.joints[branch.first].parent_position_m)
        hip = frames[link, :3, :3] @ place + frames[link, :3, 3]
        np.testing.assert_allclose(frames[branch.first, :3, 3], hip, atol=1e-12)


def test_gimbal_lock_is_far_from_standing_squatting_and_sitting(person):
    """The three turns of the pelvis stay independent at any tilt: its axes span space with 0.5 at the least."""
    for tilt in np.linspace(-np.pi, np.pi, 13):
        frames = axis_frames(person, posed(pelvis_tilt=tilt, pelvis_rotation=2.0, pelvis_obliquity=0.5))[0]
        assert np.linalg.svd(frames[3:6, :3, 2])[1][-1] > 0.5


def test_landmarks_are_on_their_segments(person):
    frames = axis_frames(person, posed())[0]
    at = {name: frames[k, :3, :3] @ x + frames[k, :3, 3] for name, (k, x) in body_landmarks(person).items()}
    for name, place in at.items():
        if name.endswith("_right"):
            np.testing.assert_allclose(at[name.replace("right", "left")], MIRROR @ place, atol=1e-12)
    assert at["asis_right"][0] > 0.05 > -0.05 > at["psis_right"][0]
    assert at["c7"][2] > at["acromion_left"][2] > at["xiphoid"][2] > at["asis_left"][2] > 0.0
    assert at["calcaneus_left"][2] < at["lateral_malleolus_left"][2] < at["medial_femoral_epicondyle_left"][2]
    links = {name: k for name, (k, _) in body_landmarks(person).items()}
    assert (
        links["acromion_left"] == WHERE.parts["scapula_left"].link
        and links["psis_left"] == WHERE.parts["pelvis"].link
    )
    assert links["radial_styloid_right"] == WHERE.parts["forearm_right"].link
    with pytest.raises(ValueError, match="whose body"):
        body_landmarks(replace(person, body=None))
