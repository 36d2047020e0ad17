"""The calibrated leg as an arm: markers where they were, masses of the table, gravity as the world has it."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import format_arm, parse_arm
from arm.body.landmarks import centre_points, limb_map
from arm.body.limbs import MEAN_PERSON, limb
from arm.body.segments import segment
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.marker_positions import marker_positions
from fitter.limb.written_arm import calibrated_arm, vector, with_landmarks, with_masses

BODY = replace(MEAN_PERSON, preset="human-leg-right", mass_kg=70.0)


@pytest.fixture(scope="module")
def arm(leg):
    return calibrated_arm(leg.fit, BODY)


def test_markers_are_where_they_were_recorded(leg, arm):
    frames, rows = leg.fit.frames_of_fit()
    q = leg.fit.bundle.q[:, -6:]
    R = frames.R @ rotation_from_rpy(*arm.base.rotation_rad)
    p = frames.R @ np.array(arm.base.position_m) + frames.p
    found = marker_positions(arm, q) @ R.mT + p[:, None]
    names = [marker.name for marker in arm.markers]
    measured = np.concatenate([r.of(names) for r in leg.truth.recordings])[rows]
    assert np.median(np.linalg.norm(found - measured, axis=2)) < 5e-3
    assert {m.name for m in arm.markers if m.joint == 0} == {"B1", "B2", "B3", "B4"}
    assert all(m.std_m == leg.fit.base_std_m for m in arm.markers if m.joint == 0)
    assert {m.name: m.landmark for m in arm.markers}["lateral_malleolus_right"] == "lateral_malleolus_right"


def test_it_is_read_back(arm):
    again = parse_arm(format_arm(arm), "file")
    assert [m.name for m in again.markers] == [m.name for m in arm.markers] and again.base == arm.base


def test_lengths_bring_their_errors(leg, arm):
    k = leg.fit.free.names.index("d3")
    assert arm.joints[2].length_std_m == leg.fit.errors.free_std[k]
    assert [i for i, joint in enumerate(arm.joints) if joint.length_std_m is not None] == [2, 3]


def test_masses_are_the_tables_and_centres_go_with_length(leg, arm):
    names = ("thigh", "shank", "foot")
    table = {name: segment(name, BODY.mass_kg, BODY.height_m, BODY.sex) for name in names}
    for name, i in zip(names, (2, 3, 5), strict=True):
        assert arm.joints[i].link.mass_kg == pytest.approx(table[name].mass_kg)
    places = centre_points(arm, leg.fit.where)
    T = axis_frames(arm, np.zeros((1, 6)))[0, 2]
    thigh = T[:3, :3] @ arm.joints[2].link.com_m + T[:3, 3]
    share = table["thigh"].centre_m / table["thigh"].length_m
    np.testing.assert_allclose(thigh, places["hip"] + share * (places["knee"] - places["hip"]), atol=1e-9)
    bare = calibrated_arm(leg.fit, None)
    assert bare.body is None and all(joint.link.mass_kg == 0.0 for joint in bare.joints)


@pytest.mark.parametrize("name", ["human-arm-right", "human-arm-left", "human-leg-right", "human-leg-left"])
def test_at_the_tables_lengths_masses_are_those_of_the_preset(name):
    preset = limb(replace(BODY, preset=name))
    for joint, own in zip(with_masses(preset, limb_map(name, preset.n_joint), BODY), preset.joints, strict=True):
        assert joint.link.mass_kg == pytest.approx(own.link.mass_kg)
        np.testing.assert_allclose(joint.link.com_m, own.link.com_m, atol=1e-9)
        np.testing.assert_allclose(joint.link.inertia_kg_m2, own.link.inertia_kg_m2, atol=1e-9)


@pytest.mark.parametrize(
    ("up", "gravity"), [("+z", [0, 0, -9.80665]), ("-y", [0, 9.80665, 0]), ("", [0, 0, -9.80665])]
)
def test_gravity_points_away_from_up(leg, up, gravity):
    fit = replace(leg.fit, trials=replace(leg.fit.trials, up=up))
    assert calibrated_arm(fit, None).gravity_m_s2 == pytest.approx(gravity)


def test_gravity_of_a_base_that_stands_is_in_frame_0(leg):
    fit = replace(leg.fit, base=replace(leg.fit.base, segment=None))
    found = calibrated_arm(fit, None)
    R = rotation_from_rpy(*found.base.rotation_rad)
    np.testing.assert_allclose(R @ found.gravity_m_s2, [0.0, 0.0, -9.80665], atol=1e-9)


def test_zeros_have_no_sign_and_other_markers_no_landmark(arm):
    assert str(vector(np.array([-0.0, 1.0, 2.0]))) == "(0.0, 1.0, 2.0)"
    first, second = with_landmarks(arm.markers[:2], {"asis_right": arm.markers[1].name})
    assert first.landmark is None and second.landmark == "asis_right"
