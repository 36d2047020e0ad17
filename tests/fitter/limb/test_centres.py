"""Centres of a leg's joints, before its fit, against where the simulation has them."""

from dataclasses import replace

import numpy as np
import pytest

from arm.body.landmarks import limb_map
from arm.kinematics import axis_frames
from benchmarks.simulated_people.person import person
from fitter.limb.centres import joint_centres
from fitter.limb.limb_trials import limb_trials

WHERE = limb_map("human-leg-right", 6)


@pytest.fixture(scope="module")
def truth():
    return person("human-leg-right", n=300, seed=3)


@pytest.fixture(scope="module")
def true_centres(truth):
    frames = axis_frames(truth.arm, truth.q[0])
    at = {"hip": frames[:, 0, :3, 3], "knee": frames[:, 3, :3, 3], "ankle": frames[:, 4, :3, 3]}
    return {name: np.einsum("nij,nj->ni", truth.R[0], x + truth.base_p) + truth.p[0] for name, x in at.items()}


def of(truth, landmarks):
    own = replace(truth.marker_set, landmarks=landmarks)
    return joint_centres(limb_trials(truth.recordings, own, WHERE), WHERE)


def test_the_hip_is_found_by_motion_and_the_knee_between_its_landmarks(truth, true_centres):
    centres, functional, notes = of(truth, truth.marker_set.landmarks)
    assert centres["hip"].method == "score" and centres["knee"].method == centres["ankle"].method == "landmarks"
    assert [one.joint for one in functional] == ["hip_right", "knee_right", "ankle_right"]
    for name, true in true_centres.items():
        for segment, world in centres[name].world_m.items():
            away = np.linalg.norm(world - true, axis=1)
            assert np.median(away) < (0.005 if name == "hip" else 0.012), (name, segment)


def test_both_segments_carry_a_centre_to_the_same_place(truth):
    centres, _, _ = of(truth, truth.marker_set.landmarks)
    for name, pair in {"hip": ("pelvis", "thigh_right"), "knee": ("thigh_right", "shank_right")}.items():
        assert set(centres[name].world_m) == set(centres[name].in_segment_m) == set(pair)
        first, second = (centres[name].world_m[segment] for segment in pair)
        assert np.median(np.linalg.norm(first - second, axis=1)) < 0.01


def test_without_landmarks_the_knee_is_on_its_hinge(truth, true_centres):
    none = {name: m for name, m in truth.marker_set.landmarks.items() if "femoral" not in name}
    centres, _, _ = of(truth, none)
    assert centres["knee"].method == "score"
    frames = axis_frames(truth.arm, truth.q[0])
    hinge = np.einsum("nij,nj->ni", truth.R[0], frames[:, 3, :3, 2])
    away = centres["knee"].world_m["thigh_right"] - true_centres["knee"]
    off = away - np.sum(away * hinge, axis=1)[:, None] * hinge
    assert np.median(np.linalg.norm(off, axis=1)) < 0.01


@pytest.mark.parametrize("moves", [False, True])
def test_what_the_pelvis_tells_of_a_hip_comes_first(truth, moves):
    first = truth.recordings[0]
    moved = replace(first, positions=first.positions[:60] if moves else np.tile(first.positions[:1], (60, 1, 1)))
    # spines 24 cm apart and 15 cm deep: Harrington's hip is below and behind, to the side
    spines = {
        "asis_right": [0.1, -0.12, 0.0], "asis_left": [0.1, 0.12, 0.0],
        "psis_right": [-0.05, -0.05, 0.0], "psis_left": [-0.05, 0.05, 0.0],
    }  # fmt: skip
    R, p = ((x[0][:60] if moves else np.tile(x[0][:1], (60, *[1] * (x[0].ndim - 1)))) for x in (truth.R, truth.p))
    world = np.einsum("nij,mj->nmi", R, np.array(list(spines.values()))) + p[:, None]
    wide = np.concatenate([moved.positions, world], axis=1)
    segments = {**truth.marker_set.segments, "pelvis": (*truth.marker_set.segments["pelvis"], *spines)}
    own = replace(
        truth.marker_set, segments=segments, landmarks=truth.marker_set.landmarks | {name: name for name in spines}
    )
    trials = limb_trials([replace(moved, names=(*moved.names, *spines), positions=wide)], own, WHERE)
    centres, _, _ = joint_centres(trials, WHERE)
    hip = centres["hip"]
    # 12.3 +- 5.9 mm from CT in 67 people (Mantovani et al. 2016)
    assert hip.method == "harrington" and hip.std_m == pytest.approx(
        np.hypot(12.3e-3, 5.9e-3) / np.sqrt(3), rel=0.01
    )
    place = (hip.world_m["pelvis"][0] - p[0]) @ R[0]
    expected = [0.1 - 0.24 * 0.15 - 9.9e-3, -(0.33 * 0.24 + 7.3e-3), -(0.30 * 0.24 + 10.9e-3)]
    np.testing.assert_allclose(place, expected, atol=2e-3)
    pelvis = trials.motions["pelvis"].whole
    carried = pelvis.R[0] @ hip.in_segment_m["pelvis"] + pelvis.p[0]
    np.testing.assert_allclose(carried, hip.world_m["pelvis"][0], atol=2e-3)


def test_a_hip_that_does_not_turn_is_left_open(truth):
    still = replace(truth.recordings[0], positions=np.tile(truth.recordings[0].positions[:1], (60, 1, 1)))
    centres, functional, notes = joint_centres(limb_trials([still], truth.marker_set, WHERE), WHERE)
    assert "hip" not in centres and "not_revealed" in {note.kind for note in notes} and functional == []
