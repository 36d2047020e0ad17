"""Persons' arms and legs: each joint moves the limb as anatomy names it, alike at either side."""

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.body.limbs import LIMBS, MEAN_PERSON, limb
from arm.kinematics import axis_frames, tip_position
from arm.model import Body
from arm.newton_euler import inverse_dynamics

ARM = ("protraction", "elevation", "flexion", "abduction", "rotation", "elbow", "pronation", "wrist", "radial")
LEG = ("flexion", "abduction", "rotation", "knee", "dorsiflexion", "inversion")


def moved(name: str, **degrees: float):
    """Return where the tip is after and before joints have moved, (3,) each; left is mirrored to the right."""
    joints = ARM if "arm" in name else LEG
    q = np.zeros((2, len(joints)))
    for joint, angle in degrees.items():
        q[0, joints.index(joint)] = np.deg2rad(angle)
    mirror = np.array([1.0, -1.0 if name.endswith("left") else 1.0, 1.0])
    return tip_position(load_arm(name), q) * mirror


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("degrees", "axis", "sign"),
    [
        ({"protraction": 20}, 0, 1), ({"elevation": 20}, 2, 1), ({"flexion": 40}, 0, 1),
        ({"abduction": 40}, 1, -1), ({"elbow": 60}, 0, 1), ({"wrist": 40}, 1, 1), ({"radial": 20}, 0, 1),
    ],
)  # fmt: skip
def test_an_arms_joints_move_the_hand_as_anatomy_says(side, degrees, axis, sign):
    after, before = moved(f"human-arm-{side}", **degrees)
    assert sign * (after - before)[axis] > 0.02


@pytest.mark.parametrize("side", ["right", "left"])
def test_inward_turns_bring_the_bent_limb_to_the_middle(side):
    for turn, bent in (({"rotation": 30}, {"elbow": 90}), ({"pronation": 60}, {"radial": 20})):
        after, before = (moved(f"human-arm-{side}", **angles)[0] for angles in ({**turn, **bent}, bent))
        assert (after - before)[1] > 0.01
    after, before = moved(f"human-leg-{side}", rotation=30)
    assert (after - before)[1] > 0.02


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("degrees", "axis", "sign"),
    [({"flexion": 40}, 0, 1), ({"abduction": 30}, 1, -1), ({"knee": 60}, 0, -1), ({"dorsiflexion": 15}, 2, 1)],
)
def test_a_legs_joints_move_the_toes_as_anatomy_says(side, degrees, axis, sign):
    after, before = moved(f"human-leg-{side}", **degrees)
    assert sign * (after - before)[axis] > 0.02


@pytest.mark.parametrize("name", LIMBS)
def test_left_is_the_mirror_image_of_right(name):
    other = name.replace("right", "left") if name.endswith("right") else name.replace("left", "right")
    q = np.random.default_rng(0).uniform(-0.7, 0.7, (20, load_arm(name).n_joint))
    mirror = np.array([1.0, -1.0, 1.0])
    np.testing.assert_allclose(
        tip_position(load_arm(name), q), tip_position(load_arm(other), q) * mirror, atol=1e-12
    )
    torque, mirrored = (inverse_dynamics(load_arm(one), q, 0.0 * q, 0.0 * q) for one in (name, other))
    np.testing.assert_allclose(torque, mirrored, atol=1e-12)


def test_an_arm_held_out_weighs_what_its_segments_do():
    """Moment of gravity about the shoulder, against sums of the table's masses and distances by hand."""
    arm = load_arm("human-arm-right")
    q = np.zeros((1, 9))
    q[0, 2] = np.pi / 2.0
    upper, fore, hand = 0.0271 * 73.0, 0.0162 * 73.0, 0.0061 * 73.0
    reach = 0.2817 * 0.5772, 0.2817 + 0.2689 * 0.4574, 0.2817 + 0.2689 + 0.0862 * 0.79
    expected = 9.80665 * np.dot([upper, fore, hand], reach)
    assert inverse_dynamics(arm, q, 0.0 * q, 0.0 * q)[0, 2] == pytest.approx(expected, rel=1e-9)


def test_from_the_scapula_the_same_arm_has_seven_joints():
    whole, part = limb(MEAN_PERSON), limb(MEAN_PERSON, "scapula")
    assert part.n_joint == 7
    assert [joint.link.mass_kg for joint in part.joints] == [joint.link.mass_kg for joint in whole.joints[2:]]
    shoulder = axis_frames(whole, np.zeros((1, 9)))[0, 2, :3, 3]
    tips = tip_position(whole, np.zeros((1, 9))) - tip_position(part, np.zeros((1, 7)))
    np.testing.assert_allclose(tips[0], shoulder, atol=1e-12)


def test_an_upper_arms_length_is_the_d_of_its_joint():
    arm = load_arm("human-arm-right")
    assert arm.joints[4].d_m == pytest.approx(-0.2817)
    assert all(joint.a_m == 0.0 for joint in arm.joints[2:5])


@pytest.mark.parametrize("name", LIMBS)
def test_whose_it_is_is_written_and_read(name):
    arm = limb(Body(name, 55.0, 1.62, "f"))
    assert parse_arm(format_arm(arm), "file") == arm
    assert sum(joint.link.mass_kg for joint in arm.joints) < 0.25 * 55.0
