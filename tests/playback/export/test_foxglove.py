"""MCAP for Foxglove: what its readers need, decoded again with the mcap library."""

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from scipy.spatial.transform import Rotation

from arm.arm_file import parse_arm
from arm.kinematics import axis_frames
from playback.export.foxglove import write_foxglove
from playback.export.sampled import Sampled
from playback.shape import base_mesh, link_meshes
from tests.protocol.mcap_doctor import examine

Topics = dict[str, list[tuple[int, dict[str, Any]]]]


def read(path: Path) -> Topics:
    found: Topics = defaultdict(list)
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            assert channel.message_encoding == "json"
            assert schema is not None and schema.encoding == "jsonschema"
            document = json.loads(message.data)
            check(document, json.loads(schema.data), channel.topic)
            found[channel.topic].append((message.log_time, document))
    return found


def check(value: object, schema: dict[str, Any], where: str) -> None:
    """Hold a document against its schema: exactly what that names, of the types that it names."""
    kinds = {"object": dict, "array": list, "number": float | int, "integer": int, "string": str, "boolean": bool}
    assert isinstance(value, kinds[schema["type"]]), where
    if isinstance(value, dict) and "properties" in schema:
        assert value.keys() == schema["properties"].keys(), where
        for name, item in value.items():
            check(item, schema["properties"][name], f"{where}.{name}")
    elif isinstance(value, list):
        for item in value[:40]:
            check(item, schema["items"], where)


def test_it_is_sound_and_indexed(tmp_path: Path, pair: Sampled) -> None:
    path = tmp_path / "pair.mcap"
    write_foxglove(path, pair, range(len(pair.t)))
    complaints = examine(path)
    assert complaints.errors == [] and complaints.warnings == []
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
        attached = {part.name: part.data for part in make_reader(file).iter_attachments()}
    assert summary is not None and summary.statistics is not None
    n = len(pair.t)
    counts = {summary.channels[k].topic: count for k, count in summary.statistics.channel_message_counts.items()}
    assert counts == {"/scene": 1, "/tf": n, "/joints": n, "/twin/joints": n}
    assert {schema.name for schema in summary.schemas.values()} == {
        "foxglove.SceneUpdate",
        "foxglove.FrameTransforms",
        "limbcal.JointMotion",
    }
    assert parse_arm(attached["arm.toml"].decode(), "arm").name == "dd-arm"
    assert [found.name for found in tmp_path.iterdir()] == ["pair.mcap"]


def test_the_tree_of_frames_is_the_arm(tmp_path: Path, motion: Sampled) -> None:
    path, mover = tmp_path / "motion.mcap", motion.movers[0]
    write_foxglove(path, motion, range(len(motion.t)))
    topics = read(path)
    frames = axis_frames(mover.arm, mover.q)
    for k in (0, 11, len(motion.t) - 1):
        t_ns, tf = topics["/tf"][k]
        assert t_ns == round(motion.t[k] * 1e9)
        poses = {"world": np.eye(4)}
        for edge in tf["transforms"]:
            T = np.eye(4)
            T[:3, :3] = Rotation.from_quat([edge["rotation"][axis] for axis in "xyzw"]).as_matrix()
            T[:3, 3] = [edge["translation"][axis] for axis in "xyz"]
            poses[edge["child_frame_id"]] = poses[edge["parent_frame_id"]] @ T
            assert edge["timestamp"] == {"sec": t_ns // 10**9, "nsec": t_ns % 10**9}
        base = poses["base"]
        pull = np.array(mover.arm.gravity_m_s2)
        assert base[:3, :3] @ pull == pytest.approx([0.0, 0.0, -np.linalg.norm(pull)], abs=1e-9)
        for i in range(mover.arm.n_joint):
            assert np.linalg.solve(base, poses[f"joint {i + 1}"]) == pytest.approx(frames[k, i], abs=1e-12)
        joints = topics["/joints"][k][1]
        assert [joints[f"q{j + 1}"] for j in range(mover.arm.n_joint)] == mover.q[k].tolist()
        assert [joints["tip"][axis] for axis in "xyz"] == mover.tip[k].tolist()


def test_the_scene_has_every_mesh_in_its_frame(tmp_path: Path, motion: Sampled) -> None:
    path, arm = tmp_path / "motion.mcap", motion.movers[0].arm
    write_foxglove(path, motion, range(len(motion.t)))
    ((t_ns, scene),) = read(path)["/scene"]
    assert t_ns == 0
    entities = {entity["id"]: entity for entity in scene["entities"]}
    assert len(entities) == len(scene["entities"]) == 2 + arm.n_joint + len(arm.sensors)
    meshes = {"base": base_mesh(arm), **{f"link {i + 1}": mesh for i, mesh in enumerate(link_meshes(arm))}}
    for name, mesh in meshes.items():
        (drawn,) = entities[name]["triangles"]
        assert np.array(drawn["indices"]).reshape(-1, 3).tolist() == mesh.faces.tolist()
        points = [[point[axis] for axis in "xyz"] for point in drawn["points"]]
        assert points == pytest.approx(mesh.vertices, abs=1e-6)
        assert entities[name]["frame_id"] == name.replace("link", "joint")
        assert entities[name]["frame_locked"] is True


def test_the_way_of_the_tip_is_a_thin_line(tmp_path: Path, pair: Sampled) -> None:
    path = tmp_path / "pair.mcap"
    write_foxglove(path, pair, range(len(pair.t)))
    ((_, scene),) = read(path)["/scene"]
    entities = {entity["id"]: entity for entity in scene["entities"]}
    for prefix, mover, opacity in zip(("", "twin/"), pair.movers, (1.0, 0.55), strict=True):
        (line,) = entities[f"{prefix}path of the tip"]["lines"]
        red, green, blue = mover.colours.trace
        assert line["color"] == {"r": red / 255.0, "g": green / 255.0, "b": blue / 255.0, "a": 0.6}
        assert (line["type"], line["thickness"], line["scale_invariant"]) == (0, 2.0, True)
        assert line["points"] == [dict(zip("xyz", tip, strict=True)) for tip in mover.tip.tolist()]
        assert line["colors"] == line["indices"] == []
        (mesh,) = entities[f"{prefix}link 1"]["triangles"]
        assert mesh["color"]["a"] == opacity
        assert (
            mesh["pose"]
            == line["pose"]
            == {
                "position": {"x": 0.0, "y": 0.0, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            }
        )
        numbers = [value for point in mesh["points"] for value in point.values()]
        assert numbers == [round(value, 6) for value in numbers]  # a micrometre
        assert entities[f"{prefix}link 1"]["frame_id"] == f"{prefix}joint 1"
    for entity in scene["entities"]:
        assert entity["timestamp"] == entity["lifetime"] == {"sec": 0, "nsec": 0}
        assert all(entity[kind] == [] for kind in ("metadata", "arrows", "cubes", "spheres", "texts", "models"))


def test_messages_are_numbered_and_arms_attached(tmp_path: Path, pair: Sampled) -> None:
    path = tmp_path / "pair.mcap"
    write_foxglove(path, pair, range(len(pair.t)))
    numbers: dict[str, list[int]] = defaultdict(list)
    with path.open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            numbers[channel.topic].append(message.sequence)
            assert message.publish_time == message.log_time
        file.seek(0)
        attached = [(one.name, one.create_time, one.log_time) for one in make_reader(file).iter_attachments()]
    n = list(range(len(pair.t)))
    assert numbers == {"/scene": [0], "/tf": n, "/joints": n, "/twin/joints": n}
    assert attached == [("arm.toml", 0, 0), ("twin_arm.toml", 0, 0)]
    t_ns, joints = read(path)["/twin/joints"][5]
    assert joints["timestamp"] == {"sec": 0, "nsec": t_ns}
    twin = pair.movers[1]
    assert [joints["dq1"], joints["ddq2"]] == [twin.dq[5, 0], twin.ddq[5, 1]]
