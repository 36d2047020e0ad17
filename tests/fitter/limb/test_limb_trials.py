"""Recordings sorted into segments: what is kept, what is left out and what is said."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.landmarks import limb_map
from benchmarks.simulated_people.person import person
from fitter.limb.limb_trials import limb_trials
from limbcal.errors import DataError

WHERE = limb_map("human-leg-right", 6)


@pytest.fixture(scope="module")
def truth():
    return person("human-leg-right", trials=2, n=80, noise_m=1e-3)


def sorted_with(truth, **changes):
    return limb_trials([replace(one, **changes) for one in truth.recordings], truth.marker_set, WHERE)


def with_point(truth, name, of, marker_set=None):
    """Return trials to which a marker was added that is some function of a recording's others."""
    recordings = [
        replace(one, names=(*one.names, name), positions=np.concatenate([one.positions, of(one)[:, None]], axis=1))
        for one in truth.recordings
    ]
    return limb_trials(recordings, marker_set or truth.marker_set, WHERE)


def kinds(trials):
    return [note.kind for note in trials.notes]


def test_segments_have_their_markers_and_landmarks(truth):
    trials = sorted_with(truth)
    assert trials.segments["pelvis"] == ("B1", "B2", "B3", "B4")
    assert set(trials.segments["shank_right"]) == {
        *(f"shank_right{k}" for k in range(3)), "lateral_malleolus_right", "medial_malleolus_right",
    }  # fmt: skip
    assert trials.whole.shape == (160, len(trials.names), 3) and trials.up == "+z" and kinds(trials) == []
    own = np.concatenate([one.of(["B2"])[:, 0] for one in truth.recordings])
    np.testing.assert_array_equal(trials.of("B2"), own)
    assert set(trials.motions) == set(trials.segments)


def test_a_landmark_computed_from_its_segment_is_no_measurement(truth):
    landmarks = {**truth.marker_set.landmarks, "greater_trochanter_right": "TRO"}

    def computed(one):
        a, b, c = (one.of([f"thigh_right{k}"])[:, 0] for k in range(3))
        return (a + b + c) / 3.0

    trials = with_point(truth, "TRO", computed, replace(truth.marker_set, landmarks=landmarks))
    assert trials.computed == frozenset() and "computed" not in kinds(trials)  # the markers' noise is its own
    exact = person("human-leg-right", trials=2, n=80, noise_m=1e-6)
    trials = with_point(exact, "TRO", computed, replace(exact.marker_set, landmarks=landmarks))
    assert "TRO" in trials.computed and kinds(trials) == ["computed"]
    assert trials.landmarks["greater_trochanter_right"] == "TRO"


def test_a_marker_that_goes_with_another_segment_is_left_out(truth):
    exact = person("human-leg-right", trials=2, n=80, noise_m=1e-5)
    segments = {**exact.marker_set.segments, "shank_right": (*exact.marker_set.segments["shank_right"], "X")}
    trials = with_point(
        exact,
        "X",
        lambda one: one.of(["thigh_right0"])[:, 0] + 0.01 * 0,
        replace(exact.marker_set, segments=segments),
    )
    (note,) = [note for note in trials.notes if note.kind == "marker_elsewhere"]
    assert note.columns == ("X",) and "X" not in trials.segments["shank_right"]
    assert "is on shank_right by the marker set, but keeps its distances to thigh_right" in note.text


def test_the_other_legs_landmarks_are_left_out_but_for_the_pelvis(truth):
    landmarks = {**truth.marker_set.landmarks, "asis_left": "B1", "lateral_malleolus_left": "B2"}
    trials = limb_trials(truth.recordings, replace(truth.marker_set, landmarks=landmarks), WHERE)
    assert trials.landmarks["asis_left"] == "B1" and "lateral_malleolus_left" not in trials.landmarks


def test_what_points_up_is_said_where_nothing_or_several_tell(truth):
    trials = sorted_with(truth, up="")
    assert trials.up == "" and kinds(trials) == ["up"] and "nothing tells" in trials.notes[0].text
    first, second = truth.recordings
    trials = limb_trials([first, replace(second, up="-y")], truth.marker_set, WHERE)
    assert trials.up == "" and "differ in which axis points up (+z, -y)" in trials.notes[0].text.replace(
        "-y, +z", "+z, -y"
    )


def test_a_pose_that_cannot_be_learnt_is_said(truth):
    positions = [one.positions.copy() for one in truth.recordings]
    at = [truth.recordings[0].names.index(name) for name in truth.marker_set.segments["pelvis"]]
    for one in positions:  # never three together
        one[::2, at[:2]] = np.nan
        one[1::2, at[2:]] = np.nan
    recordings = [replace(one, positions=x) for one, x in zip(truth.recordings, positions, strict=True)]
    trials = limb_trials(recordings, truth.marker_set, WHERE)
    assert "pelvis" not in trials.motions and "no_pose" in kinds(trials)


def test_too_few_frames_or_no_thigh_are_refused(truth):
    few = [replace(one, positions=one.positions[:2]) for one in truth.recordings]
    with pytest.raises(DataError, match="4 frames in all, expected 5"):
        limb_trials(few, truth.marker_set, WHERE)
    segments = {**truth.marker_set.segments, "thigh_right": ("OTHER",)}
    landmarks = {
        k: v for k, v in truth.marker_set.landmarks.items() if "femoral" not in k and "trochanter" not in k
    }
    with pytest.raises(DataError, match="no marker of thigh_right is in the recordings, expected some: OTHER"):
        limb_trials(truth.recordings, replace(truth.marker_set, segments=segments, landmarks=landmarks), WHERE)
