"""Tables of a motion, read back."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.kinematics import axis_frames
from fitter.export.motion_tables import coordinates_mot, marker_places, markers_trc
from protocol.markers.trc_file import read_trc
from tests.fitter.export.tables import table


def test_coordinates_are_the_motions_in_radians_and_metres(carried, motion):
    t, q, base = motion
    text = coordinates_mot(carried, t, q, base)
    names, columns = table(text)
    assert "inDegrees=no" in text and f"nRows={len(t)}" in text and f"nColumns={len(names)}" in text
    value = dict(zip(names, columns.T, strict=True))
    np.testing.assert_allclose(value["time"], t, atol=1e-8)
    np.testing.assert_allclose(np.column_stack([value[f"q{i + 1}"] for i in range(carried.n_joint)]), q, atol=1e-8)
    np.testing.assert_allclose(np.column_stack([value[f"base_t{a}"] for a in "xyz"]), base[:, :3], atol=1e-8)
    turns = Rotation.from_euler("XYZ", np.column_stack([value[f"base_r{a}"] for a in "xyz"])).as_matrix()
    np.testing.assert_allclose(turns, Rotation.from_quat(base[:, [4, 5, 6, 3]]).as_matrix(), atol=1e-7)


def test_a_turning_base_makes_no_leaps(carried):
    angle = np.linspace(0.0, 9.0, 200)
    quaternion = Rotation.from_euler("x", angle[:, None]).as_quat()[:, [3, 0, 1, 2]]
    base = np.hstack([np.zeros((200, 3)), quaternion])
    names, columns = table(coordinates_mot(carried, np.arange(200.0), np.zeros((200, carried.n_joint)), base))
    np.testing.assert_allclose(columns[:, names.index("base_rx")], angle, atol=1e-7)


def test_a_standing_arm_has_joints_alone(carried, motion):
    t, q, base = motion
    standing = replace(carried, base=replace(carried.base, segment=None))
    for arm, where in ((standing, base), (carried, None)):
        names, _ = table(coordinates_mot(arm, t, q, where))
        assert names == ["time", *(f"q{i + 1}" for i in range(carried.n_joint))]


def test_markers_ride_on_their_links_and_the_base(carried, motion):
    _, q, base = motion
    R = Rotation.from_quat(base[:, [4, 5, 6, 3]]).as_matrix()
    own = Rotation.from_euler("ZYX", carried.base.rotation_rad[::-1]).as_matrix()
    frames = axis_frames(carried, q)
    found = marker_places(carried, q, base)
    for m, marker in enumerate(carried.markers):
        x = np.array(marker.position_m)
        if marker.joint:
            T = frames[:, marker.joint - 1]
            x = T[:, :3, :3] @ x + T[:, :3, 3]
        in_segment = np.broadcast_to(x, (len(q), 3)) @ own.T + carried.base.position_m
        np.testing.assert_allclose(found[:, m], np.einsum("nij,nj->ni", R, in_segment) + base[:, :3], atol=1e-9)


def test_a_trc_is_read_back(tmp_path, carried, motion):
    t, q, base = motion
    places = marker_places(carried, q, base)
    path = tmp_path / "model.trc"
    path.write_text(markers_trc("model.trc", [m.name for m in carried.markers], t, places, 50.0))
    found = read_trc(path)
    assert found.labels == tuple(m.name for m in carried.markers) and found.t0_s == pytest.approx(2.0)
    np.testing.assert_allclose(found.points, places, atol=1e-6)
