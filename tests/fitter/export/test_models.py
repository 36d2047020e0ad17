"""Files for OpenSim and biorbd: read back by plain readers, and by the programs themselves where they are."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm
from arm.model import Base, Marker
from arm.moving_base import BaseState, carried_inverse_dynamics
from fitter.export.biomod_model import biomod_model
from fitter.export.motion_tables import coordinates_mot, marker_places, markers_trc
from fitter.export.osim_model import BASE_COORDINATES, osim_model
from fitter.export.placements import placements
from protocol.markers.trc_file import read_trc


@pytest.fixture
def carried():
    arm = load_arm("human-arm-right")
    markers = tuple(Marker(f"M{k}", k, (0.01 * k, 0.02, -0.1)) for k in range(arm.n_joint + 1))
    return replace(arm, base=Base((0.02, -0.1, 0.3), (0.2, -0.4, 0.7), "thorax"), markers=markers)


@pytest.fixture
def motion(carried):
    rng = np.random.default_rng(0)
    turns = Rotation.from_rotvec(0.4 * rng.normal(size=(9, 3))).as_quat()
    base = np.hstack([rng.normal(size=(9, 3)), turns[:, [3, 0, 1, 2]]])
    return np.arange(9) / 50.0 + 2.0, 0.5 * rng.normal(size=(9, carried.n_joint)), base


def numbers(element, path):
    return np.array([float(x) for x in element.findtext(path).split()])


def table(text):
    rows = text.split("endheader\n")[1].splitlines()
    return rows[0].split("\t"), np.array([[float(x) for x in row.split("\t")] for row in rows[1:]])


def test_an_osim_files_joints_put_the_markers_where_the_arm_has_them(carried, motion):
    t, q, base = motion
    model = ElementTree.fromstring(osim_model(carried).partition("\n")[2]).find("Model")
    names, columns = table(coordinates_mot(carried, t, q, base))
    wanted = marker_places(carried, q, base)
    for k, row in enumerate(columns):
        value = dict(zip(names, row, strict=True))
        body = np.eye(4)
        body[:3, :3] = Rotation.from_euler("XYZ", [value[f"base_r{a}"] for a in "xyz"]).as_matrix()
        body[:3, 3] = [value[f"base_t{a}"] for a in "xyz"]
        bodies = {"base": body}
        for i, joint in enumerate(model.iter("PinJoint")):
            before = joint.find("frames")[0]
            at = np.eye(4)
            at[:3, :3] = Rotation.from_euler("XYZ", numbers(before, "orientation")).as_matrix()
            at[:3, 3] = numbers(before, "translation")
            at[:3, :3] = at[:3, :3] @ Rotation.from_euler("Z", value[f"q{i + 1}"]).as_matrix()
            bodies[f"link{i + 1}"] = bodies[before.findtext("socket_parent").removeprefix("/bodyset/")] @ at
        for m, marker in enumerate(model.iter("Marker")):
            T = bodies[marker.findtext("socket_parent_frame").removeprefix("/bodyset/")]
            np.testing.assert_allclose(T[:3, :3] @ numbers(marker, "location") + T[:3, 3], wanted[k, m], atol=1e-7)


def test_inertias_are_about_the_centre_of_mass(carried):
    placed = placements(carried)
    link = carried.joints[4].link
    x, y, z = link.com_m
    assert placed.inertia_kg_m2[4, 0, 0] == pytest.approx(link.inertia_kg_m2[0] - link.mass_kg * (y * y + z * z))
    assert np.linalg.eigvalsh(placed.inertia_kg_m2[4]).min() > 0.0


def test_gravity_of_a_standing_base_is_turned_into_the_world(carried):
    standing = replace(carried, base=replace(carried.base, segment=None))
    R = Rotation.from_euler("ZYX", [0.7, -0.4, 0.2]).as_matrix()
    np.testing.assert_allclose(placements(standing).gravity_m_s2, R @ carried.gravity_m_s2, atol=1e-12)
    np.testing.assert_allclose(placements(carried).gravity_m_s2, carried.gravity_m_s2)


def test_a_trc_is_read_back(tmp_path, carried, motion):
    t, q, base = motion
    places = marker_places(carried, q, base)
    path = tmp_path / "model.trc"
    path.write_text(markers_trc("model.trc", [m.name for m in carried.markers], t, places, 50.0))
    found = read_trc(path)
    assert found.labels == tuple(m.name for m in carried.markers) and found.t0_s == pytest.approx(2.0)
    np.testing.assert_allclose(found.points, places, atol=1e-6)


def test_opensim_has_the_markers_in_the_same_places(tmp_path, carried, motion):
    opensim = pytest.importorskip("opensim", reason="OpenSim is not installed")
    t, q, base = motion
    (tmp_path / "arm.osim").write_text(osim_model(carried))
    names, columns = table(coordinates_mot(carried, t, q, base))
    model = opensim.Model(str(tmp_path / "arm.osim"))
    state = model.initSystem()
    for k, row in enumerate(columns):
        for name, value in list(zip(names, row, strict=True))[1:]:
            model.updCoordinateSet().get(name).setValue(state, float(value), False)
        model.realizePosition(state)
        for m, marker in enumerate(carried.markers):
            place = model.getMarkerSet().get(marker.name).getLocationInGround(state).to_numpy()
            np.testing.assert_allclose(place, marker_places(carried, q, base)[k, m], atol=1e-7)


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


def test_opensims_inverse_dynamics_is_ours(tmp_path):
    opensim = pytest.importorskip("opensim", reason="OpenSim is not installed")
    arm = replace(load_arm("human-leg-right"), base=Base((0.02, -0.1, 0.3), (0.2, -0.4, 0.7), "pelvis"))
    rng = np.random.default_rng(1)
    q, dq, ddq = rng.normal(size=(3, 1, arm.n_joint))
    # turns about body-fixed x, y, z by ax, ay, az and their derivatives, then shifts
    own, rate, second = rng.normal(size=(3, 6))
    step = 1e-4

    def turned(s):
        return Rotation.from_euler("XYZ", own[:3] + s * rate[:3] + 0.5 * s * s * second[:3]).as_matrix()

    before, R, after = turned(-step), turned(0.0), turned(step)
    first, curve = (after - before) / (2 * step), (after - 2 * R + before) / step**2
    spin = first @ R.T
    bent = curve @ R.T + first @ first.T
    omega, omega_dot = (
        np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]]) / 2 for W in (spin, bent)
    )
    placed = placements(arm).frame_0
    lever = R @ placed[:3, 3]
    swing = np.cross(omega_dot, lever) + np.cross(omega, np.cross(omega, lever))
    base = BaseState(
        (R @ placed[:3, :3])[None],
        (own[3:] + lever)[None],
        omega[None],
        omega_dot[None],
        (second[3:] + swing)[None],
    )
    (tmp_path / "leg.osim").write_text(osim_model(arm))
    model = opensim.Model(str(tmp_path / "leg.osim"))
    state = model.initSystem()
    coordinates = model.updCoordinateSet()
    names = [*BASE_COORDINATES, *(f"q{i + 1}" for i in range(arm.n_joint))]
    values = (np.concatenate([own, q[0]]), np.concatenate([rate, dq[0]]), np.concatenate([second, ddq[0]]))
    for name, value, speed in zip(names, *values[:2], strict=True):
        coordinates.get(name).setValue(state, float(value), False)
        coordinates.get(name).setSpeedValue(state, float(speed))
    model.realizeVelocity(state)
    order = [coordinates.get(k).getName() for k in range(coordinates.getSize())]
    udot = opensim.Vector(len(order), 0.0)
    for k, name in enumerate(order):
        udot[k] = float(values[2][names.index(name)])
    found = opensim.InverseDynamicsSolver(model).solve(state, udot).to_numpy()
    theirs = [found[order.index(f"q{i + 1}")] for i in range(arm.n_joint)]
    np.testing.assert_allclose(theirs, carried_inverse_dynamics(arm, q, dq, ddq, base)[0], atol=2e-5)
