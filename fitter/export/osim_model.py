"""OpenSim's model file of an arm: pins, sliders, markers, masses; six coordinates where a segment carries it."""

from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from arm.base_pose import is_carried
from arm.model import Arm, Floats
from fitter.export.placements import BASE, link_name, placed_on, placements

#: Coordinates of the joint that carries the base: turns about body-fixed x, y, z [rad], then shifts [m].
BASE_COORDINATES = ("base_rx", "base_ry", "base_rz", "base_tx", "base_ty", "base_tz")
#: The file format that OpenSim 4.0 and later read.
_VERSION = "40000"
#: Cosine of the second turn from which on the first and the last are about one axis, but for rounding.
_LOCKED = 1e-9
#: OpenSim refuses chains of massless bodies: such ones get this mass [kg] and inertia [kg m²], a speck of dust's.
_SPECK_KG, _SPECK_KG_M2 = 1e-6, 1e-9
#: Where joints have no range of their own [rad or m].
_ANY_RANGE = {"revolute": (-np.pi, np.pi), "prismatic": (-1.0, 1.0)}


def osim_model(arm: Arm) -> str:
    """Return the text of an .osim file; coordinates are q1…, bodies link1…, as the joints are numbered."""
    placed = placements(arm)
    root = ElementTree.Element("OpenSimDocument", Version=_VERSION)
    model = ElementTree.SubElement(root, "Model", name=arm.name)
    _text(model, "gravity", placed.gravity_m_s2)
    _text(model, "length_units", "meters")
    _text(model, "force_units", "N")
    bodies = _objects(model, "BodySet")
    joints = _objects(model, "JointSet")
    markers = _objects(model, "MarkerSet")
    _body(bodies, BASE, 0.0, np.zeros(3), np.zeros((3, 3)))
    if is_carried(arm):
        ranges = [(-np.pi, np.pi)] * 3 + [(-10.0, 10.0)] * 3
        coordinates = tuple(zip(BASE_COORDINATES, ranges, strict=True))
        _freely(_joint(joints, "CustomJoint", BASE, "/ground", BASE, np.eye(4), coordinates))
    else:
        _joint(joints, "WeldJoint", BASE, "/ground", BASE, np.eye(4), ())
    for i, joint in enumerate(arm.joints):
        name = link_name(i + 1)
        _body(bodies, name, placed.mass_kg[i], placed.centre_m[i], placed.inertia_kg_m2[i])
        parent, at = placed_on(placed, i)
        kind = "PinJoint" if joint.type == "revolute" else "SliderJoint"
        coordinate = ((f"q{i + 1}", joint.limits or _ANY_RANGE[joint.type]),)
        _joint(joints, kind, f"joint{i + 1}", f"/bodyset/{parent}", name, at, coordinate)
    for one in arm.markers:
        marker = ElementTree.SubElement(markers, "Marker", name=one.name)
        _text(marker, "socket_parent_frame", f"/bodyset/{link_name(one.joint)}")
        place = np.array(one.position_m)
        if one.joint == 0:  # frame 0 is no body of its own
            place = placed.frame_0[:3, :3] @ place + placed.frame_0[:3, 3]
        _text(marker, "location", place)
        _text(marker, "fixed", "true")
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8" ?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _objects(model: ElementTree.Element, kind: str) -> ElementTree.Element:
    return ElementTree.SubElement(ElementTree.SubElement(model, kind), "objects")


def _body(bodies: ElementTree.Element, name: str, mass_kg: float, centre_m: Floats, inertia: Floats) -> None:
    if mass_kg == 0.0:
        mass_kg, inertia = _SPECK_KG, inertia + _SPECK_KG_M2 * np.eye(3)
    body = ElementTree.SubElement(bodies, "Body", name=name)
    _text(body, "mass", np.atleast_1d(mass_kg))
    _text(body, "mass_center", centre_m)
    _text(body, "inertia", inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])


def _joint(
    joints: ElementTree.Element,
    kind: str,
    name: str,
    parent: str,
    child: str,
    at: Floats,
    coordinates: tuple[tuple[str, tuple[float, float]], ...],
) -> ElementTree.Element:
    """Add a joint whose parent frame is placed ``at`` (4, 4); a slider, which goes along x, is turned to z."""
    turn = Rotation.from_euler("y", -90.0, degrees=True).as_matrix() if kind == "SliderJoint" else np.eye(3)
    joint = ElementTree.SubElement(joints, kind, name=name)
    _text(joint, "socket_parent_frame", f"{name}_before")
    _text(joint, "socket_child_frame", f"{name}_after")
    listed = ElementTree.SubElement(joint, "coordinates")
    for coordinate, reach in coordinates:
        one = ElementTree.SubElement(listed, "Coordinate", name=coordinate)
        _text(one, "range", np.array(reach))
        _text(one, "clamped", "false")
    frames = ElementTree.SubElement(joint, "frames")
    for which, owner, R, p in (
        ("before", parent, at[:3, :3] @ turn, at[:3, 3]),
        ("after", f"/bodyset/{child}", turn, np.zeros(3)),
    ):
        frame = ElementTree.SubElement(frames, "PhysicalOffsetFrame", name=f"{name}_{which}")
        _text(frame, "socket_parent", owner)
        _text(frame, "translation", p)
        _text(frame, "orientation", _body_xyz(R))
    return joint


def _freely(joint: ElementTree.Element) -> None:
    """Let a custom joint move along all six coordinates, whose speeds are then their derivatives.

    OpenSim's FreeJoint would not do: its speeds are angular velocities, and inverse dynamics of a MOT takes them
    for derivatives.
    """
    transform = ElementTree.SubElement(joint, "SpatialTransform")
    for k, coordinate in enumerate(BASE_COORDINATES):
        name = f"{'rotation' if k < 3 else 'translation'}{k % 3 + 1}"  # noqa: PLR2004 - three of each
        axis = ElementTree.SubElement(transform, "TransformAxis", name=name)
        _text(axis, "coordinates", coordinate)
        _text(axis, "axis", np.eye(3)[k % 3])
        _text(
            ElementTree.SubElement(axis, "LinearFunction", name="function"), "coefficients", np.array([1.0, 0.0])
        )


def _body_xyz(R: Floats) -> Floats:
    """Return turns about body-fixed x, y, z, (3,) [rad]; the last is zero where it turns as the first does."""
    across = float(np.hypot(R[0, 0], R[0, 1]))
    second = np.arctan2(R[0, 2], across)
    if across < _LOCKED:
        return np.array([np.arctan2(R[2, 1], R[1, 1]), second, 0.0])
    return np.array([np.arctan2(-R[1, 2], R[2, 2]), second, np.arctan2(-R[0, 1], R[0, 0])])


def _text(parent: ElementTree.Element, name: str, value: str | Floats) -> None:
    text = value if isinstance(value, str) else " ".join(repr(float(x)) for x in value)
    ElementTree.SubElement(parent, name).text = text
