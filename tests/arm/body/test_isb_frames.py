"""Anatomical frames against landmarks that are placed by hand: x forward, y up, z to the right."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.body.isb_frames import SEGMENTS, isb_frame

MIRROR = np.diag([1.0, 1.0, -1.0])
#: A person who stands, [forward, up, right] m. Points are off wherever a frame may not follow them: a bone's axis
#: counts before the line across it, at the shank and the pelvis the line across before the axis.
TRUNK = {
    "asis_right": (0.0, 1.0, 0.12), "asis_left": (0.0, 1.0, -0.12),
    "psis_right": (-0.15, 1.0, 0.05), "psis_left": (-0.15, 1.0, -0.03),
    "suprasternal_notch": (0.06, 1.40, 0.0), "c7": (-0.06, 1.50, 0.0),
    "xiphoid": (0.10, 1.20, 0.0), "t8": (-0.10, 1.30, 0.0),
}  # fmt: skip
RIGHT = {
    "shoulder": (0.0, 1.4, 0.20),
    "lateral_epicondyle": (0.01, 1.12, 0.23), "medial_epicondyle": (-0.01, 1.10, 0.17),
    "ulnar_styloid": (0.0, 0.85, 0.20), "radial_styloid": (0.0, 0.83, 0.26),
    "second_metacarpal": (0.01, 0.75, 0.26), "fifth_metacarpal": (-0.01, 0.77, 0.20),
    "hip": (0.0, 0.95, 0.09), "lateral_femoral_epicondyle": (0.0, 0.52, 0.14),
    "medial_femoral_epicondyle": (0.0, 0.50, 0.04), "knee": (0.0, 0.51, 0.11),
    "lateral_malleolus": (0.0, 0.08, 0.13), "medial_malleolus": (0.0, 0.08, 0.05),
    "calcaneus": (-0.05, 0.03, 0.09),
    "first_metatarsal": (0.14, 0.03, 0.04), "fifth_metatarsal": (0.10, 0.03, 0.14),
}  # fmt: skip
SIDED = [segment for segment in SEGMENTS if segment not in ("pelvis", "thorax")]
NAMES = ["pelvis", "thorax", *(f"{segment}_{side}" for segment in SIDED for side in ("right", "left"))]


def standing():
    points = {name: np.array(at) for name, at in TRUNK.items()}
    points |= {f"{name}_right": np.array(at) for name, at in RIGHT.items()}
    return points | {f"{name}_left": MIRROR @ np.array(at) for name, at in RIGHT.items()}


@pytest.fixture
def drawn():
    """Return landmarks that are where nobody has them."""
    rng = np.random.default_rng(2)
    return {name: at + rng.normal(scale=0.02, size=3) for name, at in standing().items()}


@pytest.mark.parametrize("segment", [name for name in NAMES if not name.startswith("hand")])
def test_of_a_person_who_stands_all_frames_are_upright(segment):
    points = standing()
    for side in ("right", "left"):  # across the bone they are level again, but as far ahead as behind
        points[f"lateral_epicondyle_{side}"][0] = points[f"medial_epicondyle_{side}"][0] = 0.0
    np.testing.assert_allclose(isb_frame(segment, points), np.eye(3), atol=1e-12)


def test_a_twisted_elbow_turns_the_upper_arm_about_its_axis():
    """Across the elbow it is 0.02 m to the front over 0.06 m to the right."""
    R = isb_frame("upper_arm_right", standing())
    np.testing.assert_allclose(R[:, 2], np.array([0.02, 0.0, 0.06]) / np.hypot(0.02, 0.06), atol=1e-12)
    np.testing.assert_allclose(R[:, 1], [0.0, 1.0, 0.0], atol=1e-12)


def test_a_hand_goes_from_the_middle_of_the_wrist_to_its_knuckles():
    points, R = standing(), isb_frame("hand_right", standing())
    wrist = (points["radial_styloid_right"] + points["ulnar_styloid_right"]) / 2.0
    knuckles = (points["second_metacarpal_right"] + points["fifth_metacarpal_right"]) / 2.0
    np.testing.assert_allclose(R.T @ (wrist - knuckles), [0.0, np.linalg.norm(wrist - knuckles), 0.0], atol=1e-12)
    line = R.T @ (points["second_metacarpal_right"] - points["fifth_metacarpal_right"])
    assert line[2] > 0.05 and abs(line[0]) < 1e-12


def test_a_pelvis_tilts_with_its_spines():
    lower = {side: np.array([-0.15, 0.95, z]) for side, z in (("right", 0.05), ("left", -0.03))}
    R = isb_frame("pelvis", standing() | {f"psis_{side}": at for side, at in lower.items()})
    np.testing.assert_allclose(R[:, 0], np.array([0.15, 0.05, 0.0]) / np.hypot(0.15, 0.05), atol=1e-12)
    np.testing.assert_allclose(R[:, 2], [0.0, 0.0, 1.0], atol=1e-12)


@pytest.mark.parametrize("segment", NAMES)
def test_a_frame_is_right_handed_and_turns_with_its_landmarks(drawn, segment):
    R, turn = isb_frame(segment, drawn), Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1.0)
    moved = {name: turn @ at + [5.0, -3.0, 1.0] for name, at in drawn.items()}
    np.testing.assert_allclose(isb_frame(segment, moved), turn @ R, atol=1e-12)


@pytest.mark.parametrize("segment", NAMES)
def test_left_is_the_mirror_image_of_right(drawn, segment):
    other = {"right": "left", "left": "right"}
    swap = lambda name: "_".join(other.get(part, part) for part in name.split("_"))  # noqa: E731
    mirrored = {swap(name): MIRROR @ at for name, at in drawn.items()}
    image = isb_frame(swap(segment), mirrored)
    np.testing.assert_allclose(image, MIRROR @ isb_frame(segment, drawn) @ MIRROR, atol=1e-12)


def test_what_is_missing_is_named():
    points = standing()
    del points["ulnar_styloid_left"]
    for segment in ("forearm_left", "hand_left"):
        with pytest.raises(KeyError, match="ulnar_styloid_left"):
            isb_frame(segment, points)
    assert isb_frame("forearm_right", points).shape == (3, 3)
    with pytest.raises(KeyError, match="tail"):
        isb_frame("tail", points)
