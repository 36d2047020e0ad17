"""The arm as meshes: one a link, in the link's joint-axis frame, sized by the arm's reach.

Nothing is known of what a real arm looks like, so this is a drawing of its geometry: a hub on every axis, a
beam from the axis to the far end of the link, a post where ``d`` moves the next axis away from there.
"""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm, Joint, Sensor
from playback.trajectory import Floats

Faces = NDArray[np.int64]
Rgb = tuple[int, int, int]

HUB = 0.055  # radius of the first hub, as a part of the reach
SLIMMEST = 0.6  # the last link's, as a part of the first's
BEAM, POST, STRUT = 0.68, 0.5, 0.16  # radii, as a part of the hub's
SIDES = 32  # of what is round
TINY_M = 1e-9


def rgb(code: str) -> Rgb:
    """Return a colour from how a web page writes it, but without the "#"."""
    red, green, blue = bytes.fromhex(code)
    return red, green, blue


class Colours(NamedTuple):
    """Red, green and blue, 0 to 255 each, of the parts of an arm and of the path of its tip."""

    link: Rgb
    base: Rgb
    sensor: Rgb
    trace: Rgb

    @classmethod
    def of(cls, link: str, base: str, sensor: str, trace: str) -> Self:
        """Return them from their codes, as `rgb` takes them."""
        return cls(rgb(link), rgb(base), rgb(sensor), rgb(trace))


REAL = Colours.of(link="4a6582", base="5c6066", sensor="de9432", trace="26466e")
TWIN = Colours.of(link="ce805c", base="b0aaa4", sensor="debe8c", trace="ba542c")


@dataclass(frozen=True)
class Mesh:
    """A closed surface of triangles, counter-clockwise as seen from outside.

    Parameters
    ----------
    vertices : ndarray of shape (k, 3)
        [m]
    faces : ndarray of int of shape (m, 3)
        Rows of ``vertices``.
    """

    vertices: Floats
    faces: Faces


def reach_m(arm: Arm) -> float:
    """Return how far the arm gets with its joints at zero, at most [m]; 1 of an arm without any length."""
    lengths, ends = {-1: 0.0}, []
    for i, joint in enumerate(arm.joints):
        parent = arm.parents[i]
        lengths[i] = lengths[parent] + _length(_hang(arm, i)) + abs(joint.d_m)
        ends.append(lengths[i] + (_length(_far_end(arm, i)) if i not in arm.parents else 0.0))
    longest = max(ends)
    return longest if longest > TINY_M else 1.0


def link_poses(arm: Arm, q: Floats) -> Floats:
    """Return where each link's mesh is in the base frame.

    Parameters
    ----------
    arm : Arm
    q : (n, n_joint) [rad or m]

    Returns
    -------
    (n, n_joint, 4, 4)
    """
    return axis_frames(arm, q)


def link_meshes(arm: Arm) -> list[Mesh]:
    """Return the mesh of every link in its joint-axis frame (origin on the axis, x along the link).

    A link carries the hub of its own axis (a cylinder, or the carriage of a prismatic joint) and what does not
    move against it: the beam to its far end, the post or rail to the next axis, struts to its sensors. The last
    link of an arm that ends in ``a = 0`` reaches to the tip's sensor, or to the farthest on it. A link that
    several joints hang on has a beam to each.
    """
    reach, meshes = reach_m(arm), []
    for i, joint in enumerate(arm.joints):
        radius, end = _hub_radius(arm, i, reach), _far_end(arm, i)
        after = [k for k, parent in enumerate(arm.parents) if parent == i]
        slim = BEAM * _hub_radius(arm, max(after, default=arm.n_joint), reach)
        parts, skeleton = [_hub(joint, radius)], []
        for at in _ends(end, [_hang(arm, k) for k in after]):
            parts += _beam(np.zeros(3), at, BEAM * radius, slim)
            skeleton.append((np.zeros(3), at))
        for k in after:
            at, child = _hang(arm, k), arm.joints[k]
            parts += _to_next_axis(child, at, _hub_radius(arm, k, reach), reach)
            skeleton.append((at, at + _offset(child)))
        for sensor in arm.sensors:
            if sensor.joint == i + 1:
                at = np.array(sensor.position_m)
                near = [_nearest(at, *bone) for bone in skeleton]
                root = near[int(np.argmin([_length(at - point) for point in near]))]
                if _length(at - root) > BEAM * radius:
                    parts += _beam(root, at, STRUT * radius, STRUT * radius)
        meshes.append(_joined(parts))
    return meshes


def base_mesh(arm: Arm) -> Mesh:
    """Return what the first axis stands on, in the base frame: a plate, and the post or rail up to the axis."""
    reach, first = reach_m(arm), arm.joints[0]
    radius, axis = _hub_radius(arm, 0, reach), _axis(first)
    down = -axis if first.d_m >= 0.0 else axis
    top, thick = 1.0 * radius, 0.5 * radius
    plate = _turned(_lathe(_chamfered(0.5 * thick, 2.0 * radius, 0.2 * thick)), axis, (top + 0.5 * thick) * down)
    foot = _turned(_lathe(_chamfered(0.5 * top, 1.1 * radius, 0.1 * top)), axis, 0.5 * top * down)
    parts = [plate, foot]
    for i in (k for k, parent in enumerate(arm.parents) if parent < 0):
        parts += _beam(np.zeros(3), _hang(arm, i), POST * radius, POST * radius)
        parts += _to_next_axis(arm.joints[i], _hang(arm, i), radius, reach)
    return _joined(parts)


def sensor_mesh(arm: Arm, sensor: Sensor) -> Mesh:
    """Return a small box where a sensor is, turned as it is, in its link's joint-axis frame."""
    radius = _hub_radius(arm, sensor.joint - 1, reach_m(arm))
    turn, place = rotation_from_rpy(*sensor.rotation_rad), np.array(sensor.position_m)
    half = 0.5 * radius * np.array([1.0, 1.0, 0.6])
    ahead = int(np.argmax(np.abs(place)))
    if _length(np.delete(place, ahead)) < 0.5 * radius:  # inside of a beam it would not be seen, so it is a collar
        half = np.full(3, 1.12 * BEAM * radius)
        half[int(np.argmax(np.abs(turn[ahead])))] *= 0.6
    box = _box(half)
    return Mesh(box.vertices @ turn.T + place, box.faces)


def _hub_radius(arm: Arm, index: int, reach: float) -> float:
    along = min(index / max(arm.n_joint, 2), 1.0)
    return HUB * reach * (1.0 - (1.0 - SLIMMEST) * along)


def _hang(arm: Arm, index: int) -> Floats:
    """Return where a joint hangs on its parent, in the parent's joint-axis frame, or in the base frame."""
    joint, parent = arm.joints[index], arm.parents[index]
    if joint.parent_position_m is not None:
        return np.array(joint.parent_position_m)
    return np.array([arm.joints[parent].a_m if parent >= 0 else 0.0, 0.0, 0.0])


def _ends(far_end: Floats, hangs: list[Floats]) -> list[Floats]:
    """Return the points that a link reaches to, each once: its far end, and where joints hang on it."""
    ends = [far_end]
    for at in hangs:
        if all(_length(at - end) > TINY_M for end in ends):
            ends.append(at)
    return ends


def _far_end(arm: Arm, index: int) -> Floats:
    """Return where the beam of a link ends, in its joint-axis frame."""
    joint, last = arm.joints[index], index not in arm.parents
    if not last or abs(joint.a_m) > TINY_M:
        return np.array([joint.a_m, 0.0, 0.0])
    riding = {sensor.name: np.array(sensor.position_m) for sensor in arm.sensors if sensor.joint == index + 1}
    if arm.tip is not None and arm.tip.sensor in riding:
        return np.asarray(riding[arm.tip.sensor] + np.array(arm.tip.offset_m))
    return max(riding.values(), key=_length, default=np.zeros(3))


def _axis(joint: Joint) -> Floats:
    """Return the joint's axis z as seen from the link before it: Rot(y, beta) Rot(x, alpha), eq. (1)."""
    return np.asarray(rotation_from_rpy(joint.alpha_rad, joint.beta_rad, 0.0)[:, 2])


def _offset(joint: Joint) -> Floats:
    return np.asarray(joint.d_m * _axis(joint))


def _hub(joint: Joint, radius: float) -> Mesh:
    if joint.type == "prismatic":
        return _box(radius * np.array([1.0, 1.0, 1.3]))
    return _lathe(_chamfered(0.95 * radius, radius, 0.12 * radius))


def _to_next_axis(joint: Joint, end: Floats, radius: float, reach: float) -> list[Mesh]:
    """Return what leads from the far end of a link to the next axis: a post, or the rail of a prismatic joint."""
    if joint.type == "revolute":
        return _beam(end, end + _offset(joint), POST * radius, POST * radius)
    # how far it travels is not known: half a reach on either side
    low, high = min(0.0, joint.d_m) - 0.5 * reach, max(0.0, joint.d_m) + 0.5 * reach
    rail = _box(np.array([0.4 * radius, 0.4 * radius, 0.5 * (high - low)]))
    frame = rotation_from_rpy(joint.alpha_rad, joint.beta_rad, 0.0)
    rail_at = end + 0.5 * (low + high) * frame[:, 2]
    return [Mesh(rail.vertices @ frame.T + rail_at, rail.faces)]


def _beam(start: Floats, end: Floats, radius: float, radius_end: float) -> list[Mesh]:
    """Return a tapered beam with round ends between two points, or nothing where they are one point."""
    length = _length(end - start)
    if length < TINY_M:
        return []
    bend = np.linspace(0.0, 0.5 * np.pi, 7)
    near = [(-radius * np.cos(b), radius * np.sin(b)) for b in bend]
    far = [(length + radius_end * np.cos(b), radius_end * np.sin(b)) for b in bend[::-1]]
    return [_turned(_lathe([*near, *far]), (end - start) / length, start)]


def _chamfered(half: float, radius: float, edge: float) -> list[tuple[float, float]]:
    """Return the profile of a cylinder with broken edges."""
    return [
        (-half, 0.0),
        (-half, radius - edge),
        (edge - half, radius),
        (half - edge, radius),
        (half, radius - edge),
        (half, 0.0),
    ]


def _lathe(profile: list[tuple[float, float]]) -> Mesh:
    """Return the solid of revolution about z of a profile (z, radius) that begins and ends on the axis."""
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(SIDES)])
    inner = [radius * ring + [0.0, 0.0, z] for z, radius in profile[1:-1]]
    poles = [[[0.0, 0.0, profile[0][0]]], [[0.0, 0.0, profile[-1][0]]]]
    now, after = np.arange(SIDES), np.roll(np.arange(SIDES), -1)
    last, n_vertex = SIDES * (len(inner) - 1), SIDES * len(inner)
    faces = [np.column_stack([np.full(SIDES, n_vertex), after, now])]
    for k in range(0, last, SIDES):
        faces += [np.column_stack([k + now, k + after, k + SIDES + after])]
        faces += [np.column_stack([k + now, k + SIDES + after, k + SIDES + now])]
    faces.append(np.column_stack([np.full(SIDES, n_vertex + 1), last + now, last + after]))
    return Mesh(np.concatenate([*inner, *poles]), np.concatenate(faces))


def _box(half: ArrayLike) -> Mesh:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.asarray(half, float)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    return Mesh(corners, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


def _turned(mesh: Mesh, axis: Floats, place: Floats) -> Mesh:
    """Return a mesh with its z along an axis and its origin at a place."""
    helper = np.eye(3)[np.argmin(np.abs(axis))]
    x = np.cross(helper, axis)
    x /= _length(x)
    return Mesh(mesh.vertices @ np.array([x, np.cross(axis, x), axis]) + place, mesh.faces)


def _joined(parts: list[Mesh]) -> Mesh:
    """Return several closed surfaces as one."""
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + start for part, start in zip(parts, first[:-1], strict=True)]
    return Mesh(np.concatenate([part.vertices for part in parts]), np.concatenate(faces))


def _nearest(point: Floats, start: Floats, end: Floats) -> Floats:
    """Return the point of a line from start to end that is nearest to a point."""
    along = end - start
    share = 0.0 if _length(along) < TINY_M else float(np.clip((point - start) @ along / (along @ along), 0.0, 1.0))
    return np.asarray(start + share * along)


def _length(vector: Floats) -> float:
    return float(np.linalg.norm(vector))
