"""A sampled motion as MCAP that Foxglove shows: JSON under schemas it knows by name.

The daemon's recordings hold motion as msgpack, which Foxglove cannot decode (it takes JSON, Protobuf, FlatBuffers
and ROS); in this file every arm is a tree of frames with its meshes, and its joints are numbers to be plotted.
"""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import CompressionType, Writer

from arm.arm_file import format_arm
from arm.kinematics import local_frames
from playback.export.foxglove_schemas import FRAME_TRANSFORMS, SCENE_UPDATE, Schema, joint_motion
from playback.export.gravity import upward
from playback.export.rotation import quaternion_between, quaternions
from playback.export.sampled import Mover, Sampled
from playback.export.whole_file import whole_file
from playback.shape import Mesh, Rgb, base_mesh, link_meshes, sensor_mesh
from playback.trajectory import Floats

WORLD = "world"  # its z is up, as Foxglove expects; the base frame's may not be
TWIN_OPACITY = 0.55
PATH_PX = 2.0

Document = Mapping[str, object]


def write_foxglove(path: Path, motion: Sampled, frames: Iterable[int]) -> None:
    """Write `/tf`, `/scene` and, per arm, `/joints`; the twin's frames and topics begin with ``twin``.

    Parameters
    ----------
    path : Path
    motion : Sampled
    frames : iterable of int
        All frames in their order, 0 to n - 1, such as a progress bar hands them through.

    Raises
    ------
    DeviceError
        If the disk fails.
    """
    with whole_file(path) as part, part.open("wb") as file:
        log = _Log(Writer(file, compression=CompressionType.ZSTD))
        for mover, prefix in zip(motion.movers, ("", "twin_"), strict=False):
            log.attach(f"{prefix}arm.toml", format_arm(mover.arm))
        scene = log.channel("/scene", SCENE_UPDATE)
        tf = log.channel("/tf", FRAME_TRANSFORMS)
        arms = [_Tree(mover, prefix) for mover, prefix in zip(motion.movers, ("", "twin/"), strict=False)]
        joints = [log.channel(f"/{tree.prefix}joints", joint_motion(tree.mover.arm.n_joint)) for tree in arms]
        log.write(scene, 0, {"deletions": [], "entities": [part for tree in arms for part in tree.entities()]})
        for k in frames:
            t_ns = round(float(motion.t[k]) * 1e9)
            log.write(tf, t_ns, {"transforms": [edge for tree in arms for edge in tree.transforms(k, t_ns)]})
            for channel, tree in zip(joints, arms, strict=True):
                log.write(channel, t_ns, tree.joints(k, t_ns))
        log.finish()


class _Log:
    """An MCAP file of JSON messages."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self._sequence: dict[int, int] = {}
        writer.start(profile="", library="limbcal")

    def attach(self, name: str, text: str) -> None:
        self._writer.add_attachment(0, 0, name, "application/toml", text.encode())

    def channel(self, topic: str, schema: Schema) -> int:
        text = json.dumps(schema).encode()
        schema_id = self._writer.register_schema(str(schema["title"]), SchemaEncoding.JSONSchema, text)
        return self._writer.register_channel(topic, MessageEncoding.JSON, schema_id)

    def write(self, channel: int, t_ns: int, document: Document) -> None:
        number = self._sequence.get(channel, 0)
        payload = json.dumps(document, allow_nan=False, separators=(",", ":")).encode()
        self._writer.add_message(channel, t_ns, payload, t_ns, number)
        self._sequence[channel] = number + 1

    def finish(self) -> None:
        self._writer.finish()  # type: ignore[no-untyped-call]


class _Tree:
    """An arm as a tree of frames: world, base, joint 1 to joint n."""

    def __init__(self, mover: Mover, prefix: str) -> None:
        self.mover, self.prefix = mover, prefix
        self._frames = [f"{prefix}base", *(f"{prefix}joint {i + 1}" for i in range(mover.arm.n_joint))]
        local = local_frames(mover.posed, mover.q)
        self._places = local[..., :3, 3]
        self._turns = np.stack([quaternions(local[:, i, :3, :3]) for i in range(mover.arm.n_joint)], axis=1)
        self._upright = quaternion_between(upward(mover.arm), np.array([0.0, 0.0, 1.0]))

    def transforms(self, k: int, t_ns: int) -> list[Document]:
        edges = [_edge(WORLD, self._frames[0], np.zeros(3), self._upright, t_ns)]
        for i, parent in enumerate(self.mover.arm.parents):
            place = self._places[k, i], self._turns[k, i]
            edges.append(_edge(self._frames[parent + 1], self._frames[i + 1], *place, t_ns))
        return edges

    def joints(self, k: int, t_ns: int) -> Document:
        mover = self.mover
        values = {
            f"{name}{j + 1}": float(rows[k, j])
            for name, rows in (("q", mover.q), ("dq", mover.dq), ("ddq", mover.ddq))
            for j in range(mover.arm.n_joint)
        }
        return {"timestamp": _time(t_ns), **values, "tip": _xyz(mover.tip[k])}

    def entities(self) -> list[Document]:
        arm, colours = self.mover.arm, self.mover.colours
        opacity = TWIN_OPACITY if self.prefix else 1.0
        meshes = [(0, "base", base_mesh(arm), colours.base)]
        meshes += [(i + 1, f"link {i + 1}", mesh, colours.link) for i, mesh in enumerate(link_meshes(arm))]
        meshes += [(sensor.joint, sensor.name, sensor_mesh(arm, sensor), colours.sensor) for sensor in arm.sensors]
        found = [
            _entity(self._frames[frame], self.prefix + name, triangles=[_triangles(mesh, colour, opacity)])
            for frame, name, mesh, colour in meshes
        ]
        path = {
            "type": 0,  # a strip
            "pose": _pose(),
            "thickness": PATH_PX,
            "scale_invariant": True,
            "points": [_xyz(point) for point in self.mover.tip],
            "color": _rgba(colours.trace, 0.6),
            "colors": [],
            "indices": [],
        }
        return [*found, _entity(self._frames[0], f"{self.prefix}path of the tip", lines=[path])]


def _entity(frame: str, name: str, **primitives: list[Document]) -> Document:
    kinds = ("metadata", "arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
    empty: dict[str, list[Document]] = {kind: [] for kind in kinds}
    stay = {"timestamp": _time(0), "lifetime": {"sec": 0, "nsec": 0}, "frame_locked": True}
    return {"frame_id": frame, "id": name, **stay, **empty, **primitives}


def _triangles(mesh: Mesh, colour: Rgb, opacity: float) -> Document:
    return {
        "pose": _pose(),
        "points": [_xyz(np.round(vertex, 6)) for vertex in mesh.vertices],
        "color": _rgba(colour, opacity),
        "colors": [],
        "indices": mesh.faces.ravel().tolist(),
    }


def _edge(parent: str, child: str, place: Floats, turn: Floats, t_ns: int) -> Document:
    return {
        "timestamp": _time(t_ns),
        "parent_frame_id": parent,
        "child_frame_id": child,
        "translation": _xyz(place),
        "rotation": dict(zip("xyzw", turn.tolist(), strict=True)),
    }


def _pose() -> Document:
    return {"position": _xyz(np.zeros(3)), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}


def _xyz(point: Floats) -> Document:
    return dict(zip("xyz", point.tolist(), strict=True))


def _rgba(colour: Rgb, opacity: float) -> Document:
    return {**dict(zip("rgb", (value / 255.0 for value in colour), strict=True)), "a": opacity}


def _time(t_ns: int) -> Document:
    return dict(zip(("sec", "nsec"), divmod(t_ns, 1_000_000_000), strict=True))
