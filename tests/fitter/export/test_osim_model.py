"""OpenSim's file of an arm: read back by a plain reader, and by OpenSim where it is."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm
from arm.model import Base
from arm.moving_base import BaseState, carried_inverse_dynamics
from fitter.export.motion_tables import coordinates_mot, marker_places
from fitter.export.osim_model import BASE_COORDINATES, osim_model
from fitter.export.placements import placed_on, placements
from tests.fitter.export.tables import table


def numbers(element, path):
    return np.array([float(x) for x in element.findtext(path).split()])


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


def test_bodies_joints_and_gravity_are_the_arms(carried):
    model = ElementTree.fromstring(osim_model(carried).partition("\n")[2]).find("Model")
    placed = placements(carried)
    np.testing.assert_array_equal(numbers(model, "gravity"), placed.gravity_m_s2)
    base, *bodies = model.iter("Body")
    assert base.get("name") == "base" and numbers(base, "mass")[0] == 1e-6
    for i, body in enumerate(bodies):
        mass, inertia = placed.mass_kg[i], placed.inertia_kg_m2[i]
        if mass == 0.0:  # a speck: OpenSim refuses bodies without mass
            mass, inertia = 1e-6, 1e-9 * np.eye(3)
        assert numbers(body, "mass")[0] == mass
        np.testing.assert_array_equal(numbers(body, "mass_center"), placed.centre_m[i])
        xx, yy, zz, xy, xz, yz = numbers(body, "inertia")
        np.testing.assert_allclose([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], inertia)
    for i, joint in enumerate(model.iter("PinJoint")):
        coordinate = joint.find("coordinates")[0]
        assert coordinate.get("name") == f"q{i + 1}"
        assert numbers(coordinate, "range").tolist() == list(carried.joints[i].limits)


def test_a_carried_base_has_six_coordinates_and_a_standing_one_none(carried):
    model = ElementTree.fromstring(osim_model(carried).partition("\n")[2]).find("Model")
    (free,) = model.iter("CustomJoint")
    axes = [(axis.findtext("coordinates"), numbers(axis, "axis").tolist()) for axis in free.iter("TransformAxis")]
    assert axes == list(zip(BASE_COORDINATES, [*np.eye(3).tolist(), *np.eye(3).tolist()], strict=True))
    standing = replace(carried, base=replace(carried.base, segment=None))
    model = ElementTree.fromstring(osim_model(standing).partition("\n")[2]).find("Model")
    assert not list(model.iter("CustomJoint")) and len(list(model.iter("WeldJoint"))) == 1


def test_a_slider_goes_along_its_own_z(carried):
    """OpenSim's slides along x of its frames; both are turned so that z of the arm's is there."""
    joints = (replace(carried.joints[0], type="prismatic", limits=None), *carried.joints[1:])
    arm = replace(carried, joints=joints, markers=())
    model = ElementTree.fromstring(osim_model(arm).partition("\n")[2]).find("Model")
    (slider,) = model.iter("SliderJoint")
    before, after = (
        Rotation.from_euler("XYZ", numbers(frame, "orientation")).as_matrix() for frame in slider.find("frames")
    )
    np.testing.assert_allclose(after[:, 0], [0.0, 0.0, 1.0], atol=1e-12)
    name, at = placed_on(placements(arm), 0)
    np.testing.assert_allclose(before @ after.T, at[:3, :3], atol=1e-9)
    assert numbers(slider.find("coordinates")[0], "range").tolist() == [-1.0, 1.0]


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
