"""Segments, centres and landmarks on the chains of arms and legs, against what anatomy and the tables have."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.landmarks import LANDMARK_STD_M, centre_points, landmark_places, limb_map, middle_of
from arm.body.limbs import LIMBS, MEAN_PERSON, limb
from arm.kinematics import axis_frames

MIRROR = np.array([1.0, -1.0, 1.0])
#: Lengths of the mean man's segments (de Leva 1996) [m].
UPPER_ARM, FOREARM, HAND, THIGH, SHANK = 0.2817, 0.2689, 0.0862, 0.4222, 0.4340
CASES = [
    (name, girdle) for name in LIMBS for girdle in ("thorax", "scapula") if "arm" in name or girdle == "thorax"
]


def person(name, girdle="thorax", **changes):
    arm = limb(replace(MEAN_PERSON, preset=name, **changes), girdle)
    return arm, limb_map(name, arm.n_joint)


def placed(arm, places, q=None):
    """Return where landmarks are in frame 0."""
    frames = axis_frames(arm, np.zeros(arm.n_joint) if q is None else q)[0]
    return {
        name: at if link < 0 else frames[link, :3, :3] @ at + frames[link, :3, 3]
        for name, (link, at) in places.items()
    }


@pytest.mark.parametrize(("name", "girdle"), CASES)
def test_parts_are_the_links_that_weigh_something(name, girdle):
    arm, where = person(name, girdle)
    heavy = [i for i, joint in enumerate(arm.joints) if joint.link.mass_kg]
    assert [part.link for part in where.parts.values() if part.begins != "girdle"] == heavy
    assert all(segment.endswith(where.side) for segment in where.parts) and name.endswith(where.side)


@pytest.mark.parametrize(("name", "girdle"), CASES)
def test_each_part_begins_where_the_one_before_ends(name, girdle):
    arm, where = person(name, girdle)
    parts, centres = list(where.parts.values()), centre_points(arm, where)
    assert [part.ends for part in parts[:-1]] == [part.begins for part in parts[1:]]
    assert set(centres) == {parts[0].begins, *(part.ends for part in parts)}


def test_an_arm_begins_at_the_thorax_or_at_the_scapula():
    assert limb_map("human-arm-left", 9).base == "thorax" and limb_map("human-arm-left", 7).base == "scapula_left"
    assert limb_map("human-leg-left", 6).base == "pelvis"
    assert [*limb_map("human-arm-left", 7).parts] == ["upper_arm_left", "forearm_left", "hand_left"]


@pytest.mark.parametrize("side", ["right", "left"])
def test_centres_are_a_segments_length_apart(side):
    outward = -1.0 if side == "right" else 1.0
    arm = centre_points(*person(f"human-arm-{side}"))
    np.testing.assert_allclose(arm["girdle"], 0.0, atol=1e-12)
    np.testing.assert_allclose(arm["shoulder"], [0.0, outward * 0.129 * 1.741, 0.0], atol=1e-12)
    down = [arm[name][2] for name in ("shoulder", "elbow", "wrist", "fingers")]
    np.testing.assert_allclose(-np.diff(down), [UPPER_ARM, FOREARM, HAND], atol=1e-9)
    leg = centre_points(*person(f"human-leg-{side}"))
    np.testing.assert_allclose(-np.diff([leg[n][2] for n in ("hip", "knee", "ankle")]), [THIGH, SHANK], atol=1e-9)
    assert leg["toes"][0] > 0.15 and leg["toes"][2] < leg["ankle"][2]


@pytest.mark.parametrize(("name", "girdle"), CASES)
def test_three_axes_of_a_ball_meet_in_its_centre(name, girdle):
    """Each passes through it, however the others are turned."""
    arm, where = person(name, girdle)
    (ball,), q = where.balls, np.zeros(arm.n_joint)
    centre = centre_points(arm, where)["shoulder" if "arm" in name else "hip"]
    q[ball : ball + 3] = [0.3, -0.5, 0.7]
    frames = axis_frames(arm, q)[0]
    for k in range(ball, ball + 3):
        np.testing.assert_allclose(np.cross(frames[k, :3, 2], centre - frames[k, :3, 3]), 0.0, atol=1e-12)


@pytest.mark.parametrize(("name", "girdle"), CASES)
def test_a_named_axis_passes_its_centre_and_moves_the_rest(name, girdle):
    arm, where = person(name, girdle)
    centres = centre_points(arm, where) | {"subtalar": centre_points(arm, where).get("ankle")}
    before = axis_frames(arm, np.zeros(arm.n_joint))[0]
    for joint, k in where.axes.items():
        q = np.zeros(arm.n_joint)
        q[k] = 0.4
        after = axis_frames(arm, q)[0]
        np.testing.assert_array_equal(after[:k], before[:k])
        assert all(np.abs(a[:3, :3] - b[:3, :3]).max() > 0.1 for a, b in zip(after[k:], before[k:], strict=True))
        at = centres["elbow" if joint == "forearm" else joint]
        off = np.cross(before[k, :3, 2], at - before[k, :3, 3])
        np.testing.assert_allclose(off, 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "joint", "direction"),
    [
        ("human-arm-right", "elbow", 1), ("human-arm-right", "forearm", 2), ("human-arm-right", "wrist", 0),
        ("human-leg-left", "knee", 1), ("human-leg-left", "ankle", 1), ("human-leg-left", "subtalar", 0),
    ],
)  # fmt: skip
def test_a_named_axis_points_where_anatomy_has_it(name, joint, direction):
    """Flexion turns about the sideways axis, pronation about the bone; wrist and inversion about the one ahead."""
    arm, where = person(name)
    axis = axis_frames(arm, np.zeros(arm.n_joint))[0, where.axes[joint], :3, 2]
    np.testing.assert_allclose(np.abs(axis), np.eye(3)[direction], atol=1e-12)


@pytest.mark.parametrize("kind", ["arm", "leg"])
def test_every_landmark_is_within_a_hand_or_foot(kind):
    """From the next centre it is at least as far as a bone is thick, and no farther than the toes."""
    arm, where = person(f"human-{kind}-right")
    centres = np.array(list(centre_points(arm, where).values()))
    for name, at in placed(arm, landmark_places(arm, where, 1.741)).items():
        assert 0.02 < np.linalg.norm(centres - at, axis=1).min() < 0.16, name


@pytest.mark.parametrize("kind", ["arm", "leg"])
def test_landmarks_lie_about_their_centres(kind):
    """Outwards is lateral, at either side; a person half as tall has half the breadth."""
    name = f"human-{kind}-right"
    arm, where = person(name)
    at, centres = placed(arm, landmark_places(arm, where, 1.741)), centre_points(arm, where)
    if kind == "arm":
        np.testing.assert_allclose(
            at["lateral_epicondyle_right"] - centres["elbow"], [0.0, -0.033, 0.0], atol=1e-12
        )
        np.testing.assert_allclose(at["ulnar_styloid_right"] - centres["wrist"], [-0.028, 0.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(at["acromion_right"] - centres["shoulder"], [0.0, 0.0, 0.045], atol=1e-12)
        assert len(at) == 7
    else:
        np.testing.assert_allclose(at["medial_malleolus_right"] - centres["ankle"], [0.0, 0.036, 0.0], atol=1e-12)
        np.testing.assert_allclose(at["calcaneus_right"] - centres["ankle"], [-0.06, 0.0, -0.03], atol=1e-12)
        assert len(at) == 9
    small, there = person(name, height_m=1.741 / 2.0)
    half, middles = placed(small, landmark_places(small, there, 1.741 / 2.0)), centre_points(small, there)
    centre = {"arm": "elbow", "leg": "knee"}[kind]
    landmark = {"arm": "medial_epicondyle_right", "leg": "lateral_femoral_epicondyle_right"}[kind]
    np.testing.assert_allclose(
        half[landmark] - middles[centre], (at[landmark] - centres[centre]) / 2.0, atol=1e-12
    )


@pytest.mark.parametrize("name", LIMBS)
def test_landmarks_of_the_left_are_those_of_the_right(name):
    other = name.replace("right", "left") if name.endswith("right") else name.replace("left", "right")
    ours, theirs = (
        placed(arm, landmark_places(arm, where, 1.741)) for arm, where in (person(name), person(other))
    )
    for landmark, at in ours.items():
        side, image = name.split("-")[-1], other.split("-")[-1]
        np.testing.assert_allclose(theirs[landmark.replace(side, image)], at * MIRROR, atol=1e-12)


@pytest.mark.parametrize(
    ("landmark", "segment"),
    [
        ("acromion", "scapula"), ("medial_epicondyle", "upper_arm"), ("radial_styloid", "forearm"),
        ("fifth_metacarpal", "hand"), ("greater_trochanter", "thigh"), ("lateral_femoral_epicondyle", "thigh"),
        ("medial_malleolus", "shank"), ("calcaneus", "foot"), ("second_metatarsal", "foot"),
    ],
)  # fmt: skip
def test_a_landmark_rides_on_its_segment(landmark, segment):
    kind = "arm" if segment in ("scapula", "upper_arm", "forearm", "hand") else "leg"
    arm, where = person(f"human-{kind}-left")
    assert landmark_places(arm, where, 1.741)[f"{landmark}_left"][0] == where.parts[f"{segment}_left"].link


def test_without_a_scapula_its_landmark_is_on_the_base():
    arm, where = person("human-arm-right", "scapula")
    link, at = landmark_places(arm, where, 1.741)["acromion_right"]
    assert link == -1
    np.testing.assert_allclose(at, [0.0, 0.0, 0.045], atol=1e-12)


@pytest.mark.parametrize(("name", "girdle"), CASES)
def test_the_middle_of_a_segment_is_as_far_from_both_ends(name, girdle):
    arm, where = person(name, girdle)
    frames, centres = axis_frames(arm, np.zeros(arm.n_joint))[0], centre_points(arm, where)
    for segment, part in where.parts.items():
        T = frames[part.link]
        at = T[:3, :3] @ middle_of(arm, where, segment) + T[:3, 3]
        np.testing.assert_allclose(centres[part.begins] - at, at - centres[part.ends], atol=1e-12)


def test_landmarks_are_off_by_a_centimetre_or_two():
    assert 0.01 <= LANDMARK_STD_M <= 0.02
