"""Forward, left and up of simulated people; recordings that a mirror has been through."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fitter.functional.marker_set import MarkerSet
from fitter.limb.base_motion import base_motion
from fitter.limb.base_orientation import (
    away_from_lock,
    base_orientation,
    mirrored,
    seen_or_posed,
    upside_down,
    world_up,
)
from fitter.limb.limb_trials import sorted_trials
from protocol.markers.recording import MarkerRecording

#: Bony points of a trunk that faces x and has y to its left [m].
THORAX = {
    "suprasternal_notch": [0.08, 0.0, 0.4],
    "c7": [-0.06, 0.0, 0.45],
    "xiphoid": [0.1, 0.0, 0.2],
    "t8": [-0.1, 0.0, 0.2],
    "acromion_right": [0.0, -0.18, 0.4],
    "acromion_left": [0.0, 0.18, 0.4],
}
PELVIS = {
    "asis_right": [0.1, -0.12, 0.0],
    "asis_left": [0.1, 0.12, 0.0],
    "psis_right": [-0.08, -0.04, 0.02],
    "psis_left": [-0.08, 0.04, 0.02],
}
LEG = {"knee1": [0.05, -0.1, -0.4], "knee2": [0.0, -0.14, -0.45]}
UNCHANGED = np.eye(3)
#: The person faces neither axis of the laboratory, whose y points up.
STANDS = Rotation.from_euler("YX", [40.0, -90.0], degrees=True)


def trials_of(points, segment, up="+y", world=UNCHANGED, hidden=()):
    """Return trials of a segment that wobbles, seen through ``world``."""
    turns = STANDS * Rotation.from_rotvec(0.1 * np.sin(np.arange(30)[:, None] / [3.0, 4.0, 5.0]))
    positions = np.einsum("nij,mj->nmi", turns.as_matrix(), np.array(list(points.values()))) @ world.T
    positions[::2, [list(points).index(name) for name in hidden]] = np.nan
    names = tuple(points)
    landmarks = {name: name for name in names if not name.startswith("knee")}
    on_it = tuple(name for name in landmarks if not name.startswith("acromion"))
    leg = tuple(name for name in names if name.startswith("knee"))
    segments = {segment: on_it} | ({"thigh_right": leg} if leg else {})
    recording = MarkerRecording("one.trc", 100.0, names, positions, "m", up)
    own = MarkerSet("own", segments, landmarks)
    return sorted_trials([recording], own, (segment, "thigh_right"), ())


def without(points, *names):
    return {name: x for name, x in points.items() if name not in names}


@pytest.mark.parametrize(("points", "segment"), [(THORAX, "thorax"), (PELVIS | LEG, "pelvis")])
def test_axes_are_forward_left_and_up_of_the_person(points, segment):
    trials = trials_of(points, segment)
    base = base_motion(trials, segment)
    axes, notes = base_orientation(trials, base, "right")
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    away = Rotation.from_matrix(base.R @ axes).mean() * STANDS.inv()
    assert np.degrees(away.magnitude()) < 5.0 and notes == ()


def test_without_both_acromions_left_is_across_the_spine():
    trials = trials_of(without(THORAX, "acromion_left", "acromion_right"), "thorax")
    base = base_motion(trials, "thorax")
    axes, _ = base_orientation(trials, base, "right")
    away = Rotation.from_matrix(base.R @ axes).mean() * STANDS.inv()
    assert np.degrees(away.magnitude()) < 5.0


@pytest.mark.parametrize(("side", "lateral"), [("right", -0.05), ("left", 0.05)])
def test_else_left_is_along_the_epicondyles(side, lateral):
    points = {
        f"lateral_epicondyle_{side}": [0.0, lateral, 0.0],
        f"medial_epicondyle_{side}": [0.0, -lateral, 0.0],
    }
    trials = trials_of(points | without(PELVIS, "asis_left", "psis_left"), "pelvis")
    base = base_motion(trials, "nothing")  # stands in the world
    axes, notes = base_orientation(trials, base, side)
    assert np.degrees((Rotation.from_matrix(axes) * STANDS.inv()).magnitude()) < 5.0
    assert notes == ()


def test_what_no_landmark_tells_is_said():
    trials = trials_of({"t8": [0.0, 0.0, 0.0], "c7": [0.0, 0.0, 0.2]}, "thorax", up="")
    axes, notes = base_orientation(trials, base_motion(trials, "nothing"), "right")
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert any("up and left of the base" in note.text for note in notes)


@pytest.mark.parametrize("lost", [(), ("acromion_left",), ("acromion_right",), ("xiphoid", "t8")])
def test_a_mirrored_thorax_is_said(lost):
    points, mirror = without(THORAX, *lost), np.diag([1.0, 1.0, -1.0])
    assert mirrored(trials_of(points, "thorax")) == ()
    (note,) = mirrored(trials_of(points, "thorax", world=mirror))
    assert note.kind == "mirrored" and "left of the thorax" in note.text
    assert ("+y does not point up" in note.text) is bool(set(lost) >= {"xiphoid", "t8"})


@pytest.mark.parametrize("lost", [(), ("asis_left",)])
def test_a_mirrored_pelvis_is_said(lost):
    points = without(PELVIS, *lost) | LEG
    assert mirrored(trials_of(points, "pelvis")) == ()
    trials = trials_of(points, "pelvis", world=np.diag([-1.0, 1.0, 1.0]))
    assert [note.kind for note in base_orientation(trials, base_motion(trials, "pelvis"), "right")[1]] == [
        "mirrored"
    ]


def test_legs_say_what_is_up_where_the_header_is_wrong():
    assert mirrored(trials_of(PELVIS | LEG, "pelvis", up="-y")) == ()
    assert mirrored(trials_of(PELVIS, "pelvis", up="-y")) != ()


def test_directions_in_one_plane_tell_of_no_mirror():
    lies = Rotation.from_euler("y", 90.0, degrees=True).as_matrix()
    flat = {name: (lies @ x).tolist() for name, x in PELVIS.items()}
    for mirror in (np.eye(3), np.diag([1.0, 1.0, -1.0])):
        assert mirrored(trials_of(flat, "pelvis", world=mirror)) == ()


def test_right_and_left_exchanged_in_names_are_said():
    exchanged = {
        name: PELVIS[name.replace("left", "x").replace("right", "left").replace("x", "right")] for name in PELVIS
    }
    assert [note.kind for note in mirrored(trials_of(exchanged | LEG, "pelvis"))] == ["mirrored"]


@pytest.mark.parametrize(
    ("up", "axis"), [("+x", [1, 0, 0]), ("-y", [0, -1, 0]), ("-z", [0, 0, -1]), ("", [0, 0, 1])]
)
def test_the_worlds_up_is_by_name(up, axis):
    assert world_up(up).tolist() == axis


def test_hidden_markers_are_carried_by_their_segment():
    whole, gaps = trials_of(THORAX, "thorax"), trials_of(THORAX, "thorax", hidden=("xiphoid",))
    np.testing.assert_allclose(seen_or_posed(gaps, "xiphoid"), whole.of("xiphoid"), atol=1e-9)
    hidden = trials_of(THORAX, "thorax", hidden=("acromion_left",))
    assert np.isnan(seen_or_posed(hidden, "acromion_left")[::2]).all()


def test_a_limb_that_stays_clear_of_the_axis_keeps_it():
    angle = np.radians(np.linspace(30.0, 150.0, 200))  # 60° about the right angle
    fan = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    assert away_from_lock(fan, np.array([0.0, 0.0, 1.0])) is None
    assert away_from_lock(fan, np.array([0.0, 1.0, 0.0])) is not None


def test_the_axis_is_turned_clear_of_the_limb_and_no_further():
    angle = np.radians(np.linspace(60.0, 120.0, 200))
    fan = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    found = away_from_lock(fan, np.array([0.0, 1.0, 0.0]))
    assert np.linalg.norm(found) == pytest.approx(1.0) and found[1] > 0.0
    nearest = np.degrees(np.arccos(np.abs(fan @ found).max()))
    turned = np.degrees(np.arccos(found[1]))
    assert 33.0 < nearest < 40.0 and 30.0 < turned < 45.0


def test_a_marker_that_comes_and_goes_tells_of_a_mirror_too():
    mirror = np.diag([1.0, 1.0, -1.0])
    trials = trials_of(THORAX, "thorax", world=mirror, hidden=("acromion_left", "t8", "xiphoid"))
    assert len(mirrored(trials)) == 1


@pytest.mark.parametrize(("points", "segment"), [(THORAX, "thorax"), (PELVIS | LEG, "pelvis")])
@pytest.mark.parametrize(("up", "inclined"), [("+y", None), ("", None), ("-y", "1[67].°"), ("+x", "(8.|9.)°")])
def test_landmarks_contradict_an_axis_that_is_not_up(points, segment, up, inclined):
    notes = upside_down(trials_of(points, segment, up))
    assert [note.kind for note in notes] == ([] if inclined is None else ["up"])
    assert inclined is None or re.search(rf"up of the {segment} {inclined} away from .{up[1]}", notes[0].text)
