"""biorbd's file of an arm: read back by a plain reader, and by biorbd where it is."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fitter.export.biomod_model import biomod_model
from fitter.export.motion_tables import coordinates_mot, marker_places
from fitter.export.placements import placements
from tests.fitter.export.tables import table


def segments(text):
    """Return by segment the words of its lines, a matrix as rows."""
    found, now = {}, None
    for line in text.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] in ("segment", "marker"):
            now = found.setdefault(words[1], {"rows": [], "last": ""})
        elif words[0] in ("endsegment", "endmarker"):
            now = None
        elif now is not None and not words[0].lstrip("-")[0].isdigit():
            now[words[0]], now["last"] = words[1:], words[0]
        elif now is not None:
            now["rows"].append((now["last"], [float(x) for x in words]))
    return found


def rows(segment, name):
    return np.array([row for of, row in segment["rows"] if of == name])


def test_segments_have_the_arms_markers_where_it_has_them(carried, motion):
    _, q, base = motion
    found = segments(biomod_model(carried))
    wanted = marker_places(carried, q, base)
    for k in range(len(q)):
        at = np.eye(4)
        at[:3, :3], at[:3, 3] = Rotation.from_quat(base[k, [4, 5, 6, 3]]).as_matrix(), base[k, :3]
        frames = {"base": at}
        for i in range(carried.n_joint):
            one, turn = found[f"link{i + 1}"], np.eye(4)
            assert one["rotations"] == ["z"]
            turn[:3, :3] = Rotation.from_euler("z", q[k, i]).as_matrix()
            frames[f"link{i + 1}"] = frames[one["parent"][0]] @ rows(one, "RT") @ turn
        for m, marker in enumerate(carried.markers):
            one = found[marker.name]
            place = np.array([float(x) for x in one["position"]])
            T = frames[one["parent"][0]]
            np.testing.assert_allclose(T[:3, :3] @ place + T[:3, 3], wanted[k, m], atol=1e-9)


def test_masses_ranges_and_gravity_are_the_arms(carried):
    text = biomod_model(carried)
    found, placed = segments(text), placements(carried)
    for i, joint in enumerate(carried.joints):
        one = found[f"link{i + 1}"]
        assert float(one["mass"][0]) == placed.mass_kg[i]
        assert [float(x) for x in one["CenterOfMass"]] == placed.centre_m[i].tolist()
        np.testing.assert_array_equal(rows(one, "inertia"), placed.inertia_kg_m2[i])
        assert rows(one, "rangesQ")[0].tolist() == list(joint.limits)
    assert f"gravity {' '.join(map(repr, map(float, placed.gravity_m_s2)))}" in text
    assert found["base"]["translations"] == ["xyz"] and found["base"]["rotations"] == ["xyz"]


def test_a_standing_base_does_not_move_and_sliders_slide(carried):
    joints = (replace(carried.joints[0], type="prismatic", limits=None), *carried.joints[1:])
    arm = replace(carried, joints=joints, base=replace(carried.base, segment=None), markers=())
    found = segments(biomod_model(arm))
    assert "translations" not in found["base"]
    assert found["link1"]["translations"] == ["z"] and rows(found["link1"], "rangesQ")[0].tolist() == [-1.0, 1.0]
    turning = replace(arm, joints=(replace(joints[0], type="revolute"), *joints[1:]))
    assert rows(segments(biomod_model(turning))["link1"], "rangesQ")[0].tolist() == [-np.pi, np.pi]


def test_a_name_is_one_word(carried):
    named = replace(carried, markers=(replace(carried.markers[1], name="upper arm 1"),))
    assert "upper_arm_1" in segments(biomod_model(named))


def test_biorbd_has_the_markers_in_the_same_places(tmp_path, carried, motion):
    biorbd = pytest.importorskip("biorbd", reason="biorbd is not installed")
    t, q, base = motion
    (tmp_path / "arm.bioMod").write_text(biomod_model(carried))
    names, columns = table(coordinates_mot(carried, t, q, base))
    model = biorbd.Model(str(tmp_path / "arm.bioMod"))
    order = [names.index(n) for n in ("base_tx", "base_ty", "base_tz", "base_rx", "base_ry", "base_rz")]
    order += [names.index(f"q{i + 1}") for i in range(carried.n_joint)]
    for k, row in enumerate(columns):
        found = [one.to_array() for one in model.markers(np.ascontiguousarray(row[order]))]
        np.testing.assert_allclose(found, marker_places(carried, q, base)[k], atol=1e-7)
