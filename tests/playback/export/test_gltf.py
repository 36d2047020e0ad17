"""glTF, read again by other libraries and evaluated as a viewer does."""

import json
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygltflib
import pytest
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from arm.kinematics import axis_frames, rotation_from_rpy
from playback.export.gltf import write_gltf
from playback.export.sampled import Sampled
from playback.shape import base_mesh, link_meshes

Floats = NDArray[np.float64]
WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Viewer:
    """What glTF 2.0 says of nodes, accessors and animations, written down independently."""

    def __init__(self, path: Path) -> None:
        self.gltf = pygltflib.GLTF2().load(str(path))
        if path.suffix == ".gltf":
            self.gltf.convert_buffers(pygltflib.BufferFormat.BINARYBLOB)
        self.blob = self.gltf.binary_blob()
        self.number = {node.name: k for k, node in enumerate(self.gltf.nodes)}
        self.parent = {child: k for k, node in enumerate(self.gltf.nodes) for child in node.children}

    def accessor(self, index: int) -> NDArray[np.generic]:
        accessor = self.gltf.accessors[index]
        view = self.gltf.bufferViews[accessor.bufferView]
        dtype = {pygltflib.FLOAT: "<f4", pygltflib.UNSIGNED_INT: "<u4"}[accessor.componentType]
        width = WIDTH[accessor.type]
        data = self.blob[view.byteOffset : view.byteOffset + view.byteLength]
        assert len(data) == 4 * width * accessor.count
        values = np.frombuffer(data, dtype).reshape(-1, width)
        if accessor.min:
            assert values.min(axis=0).tolist() == accessor.min
            assert values.max(axis=0).tolist() == accessor.max
        return values

    def pose(self, name: str, t: float) -> Floats:
        """Return the global pose of a node while the animation is at t."""
        k: int | None = self.number[name]
        T = np.eye(4)
        while k is not None:
            T = self.local(k, t) @ T
            k = self.parent.get(k)
        return T

    def local(self, k: int, t: float) -> Floats:
        node = self.gltf.nodes[k]
        turn = Rotation.from_quat(node.rotation or [0.0, 0.0, 0.0, 1.0])
        place = np.array(node.translation or [0.0, 0.0, 0.0])
        for animation in self.gltf.animations:
            for channel in animation.channels:
                if channel.target.node == k:
                    sampler = animation.samplers[channel.sampler]
                    assert sampler.interpolation == "LINEAR"
                    assert self.gltf.accessors[sampler.input].min  # which the standard asks of times
                    times = self.accessor(sampler.input)[:, 0].astype(float)
                    values = self.accessor(sampler.output).astype(float)
                    if channel.target.path == "rotation":
                        turn = Slerp(times, Rotation.from_quat(values))(min(t, times[-1]))
                    else:
                        place = np.array([np.interp(t, times, values[:, i]) for i in range(3)])
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = turn.as_matrix(), place
        return T


@pytest.fixture
def written(tmp_path: Path, motion: Sampled) -> Path:
    path = tmp_path / "motion.glb"
    write_gltf(path, motion)
    assert [found.name for found in tmp_path.iterdir()] == [path.name]
    return path


def upright(motion: Sampled) -> Floats:
    """Return the turn after which gravity pulls along -y."""
    pull = np.array(motion.movers[0].arm.gravity_m_s2)
    return Rotation.align_vectors([[0.0, -1.0, 0.0]], [pull])[0].as_matrix()


def test_every_joint_and_the_tip_are_where_the_arm_has_them(written: Path, motion: Sampled) -> None:
    viewer, mover = Viewer(written), motion.movers[0]
    root = viewer.pose("limbcal", 0.0)[:3, :3]
    pull = np.array(mover.arm.gravity_m_s2)
    assert root @ pull == pytest.approx([0.0, -np.linalg.norm(pull), 0.0], abs=1e-6)
    frames = axis_frames(mover.arm, mover.q)
    for k in (0, 7, 18, len(motion.t) - 1):
        tip = viewer.pose("tip", motion.t[k])[:3, 3]
        assert root.T @ tip == pytest.approx(mover.tip[k], abs=1e-6)
        for i in range(mover.arm.n_joint):
            pose = viewer.pose(f"joint {i + 1}", motion.t[k])
            assert root.T @ pose[:3, :3] == pytest.approx(frames[k, i, :3, :3], abs=1e-6)
    for s, sensor in enumerate(mover.arm.sensors):
        pose = viewer.pose(sensor.name, motion.t[9])
        assert root.T @ pose[:3, 3] == pytest.approx(mover.points[9, s], abs=1e-6)
        turn = frames[9, sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
        assert root.T @ pose[:3, :3] == pytest.approx(turn, abs=1e-6)


def test_between_two_frames_a_joint_turns_evenly(written: Path, motion: Sampled) -> None:
    viewer, mover = Viewer(written), motion.movers[0]
    between = 0.5 * (mover.q[3] + mover.q[4])
    frames = axis_frames(mover.arm, between[None])[0]
    root = viewer.pose("limbcal", 0.0)[:3, :3]
    last = viewer.pose(f"joint {mover.arm.n_joint}", 0.5 * (motion.t[3] + motion.t[4]))
    assert root.T @ last[:3, 3] == pytest.approx(frames[-1, :3, 3], abs=1e-6)


def test_rotations_keep_their_sign(written: Path) -> None:
    viewer = Viewer(written)
    for animation in viewer.gltf.animations:
        times = {viewer.gltf.accessors[sampler.input].count for sampler in animation.samplers}
        assert times == {31}
        for channel in animation.channels:
            if channel.target.path == "rotation":
                q = viewer.accessor(animation.samplers[channel.sampler].output)
                assert np.all(np.sum(q[1:] * q[:-1], axis=1) > 0.0)


def test_another_library_sees_the_meshes(written: Path, motion: Sampled) -> None:
    arm = motion.movers[0].arm
    scene = trimesh.load(written)
    assert len(scene.geometry) == 1 + arm.n_joint + len(arm.sensors)
    solids = scene.dump()
    assert sum(solid.volume for solid in solids) > 0.0
    expected = sum(len(mesh.faces) for mesh in [base_mesh(arm), *link_meshes(arm)]) + 12 * len(arm.sensors)
    assert sum(len(solid.faces) for solid in solids) == expected
    for solid in solids:
        lengths = np.linalg.norm(solid.vertex_normals, axis=1)
        assert lengths == pytest.approx(1.0, abs=1e-5)


def test_the_container_is_as_the_specification_says(tmp_path: Path, pair: Sampled) -> None:
    path = tmp_path / "pair.glb"
    write_gltf(path, pair)
    data = path.read_bytes()
    magic, version, length, json_length, json_kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, length, json_kind) == (b"glTF", 2, len(data), b"JSON")
    assert json_length % 4 == 0
    document = json.loads(data[20 : 20 + json_length])
    assert document["asset"]["version"] == "2.0"
    assert {view["byteOffset"] % 4 for view in document["bufferViews"]} == {0}
    names = {node["name"] for node in document["nodes"]}
    assert {"limbcal", "dd-arm", "dd-arm (twin)", "joint 2", "joint 2 (twin)", "tip (twin)", "s4"} <= names
    modes = {material["name"]: material["alphaMode"] for material in document["materials"]}
    assert (modes["link"], modes["link (twin)"]) == ("OPAQUE", "BLEND")
    viewer = Viewer(path)
    root = viewer.pose("limbcal", 0.0)[:3, :3]
    for name, mover in zip(("tip", "tip (twin)"), pair.movers, strict=True):
        assert root.T @ viewer.pose(name, pair.t[20])[:3, 3] == pytest.approx(mover.tip[20], abs=1e-6)


def test_a_gltf_is_the_same_as_text(tmp_path: Path, pair: Sampled) -> None:
    viewers = []
    for path in (tmp_path / "pair.glb", tmp_path / "pair.gltf"):
        write_gltf(path, pair)
        viewers.append(Viewer(path))
    binary, text = viewers
    assert json.loads((tmp_path / "pair.gltf").read_text())["buffers"][0]["uri"].startswith("data:")
    assert bytes(binary.blob) == bytes(text.blob)
    assert len(binary.gltf.accessors) == len(text.gltf.accessors)
    assert [node.name for node in binary.gltf.nodes] == [node.name for node in text.gltf.nodes]


def test_surfaces_are_matt_and_their_colours_linear_light(tmp_path: Path, pair: Sampled) -> None:
    path = tmp_path / "pair.glb"
    write_gltf(path, pair)
    gltf = Viewer(path).gltf
    surfaces = {material.name: material.pbrMetallicRoughness for material in gltf.materials}
    assert list(surfaces) == [f"{name}{twin}" for twin in ("", " (twin)") for name in ("link", "base", "sensor")]
    for name, surface in surfaces.items():
        assert (surface.metallicFactor, surface.roughnessFactor) == (0.1, 0.55)
        assert surface.baseColorFactor[3] == (0.55 if "twin" in name else 1.0)
    # of #4a6582 by IEC 61966-2-1: 74, 101 and 130 of 255
    assert surfaces["link"].baseColorFactor[:3] == pytest.approx([0.06847817, 0.13013648, 0.22322796], abs=1e-6)
    assert gltf.scene == 0 and len(gltf.scenes) == 1 and gltf.scenes[0].name == pair.title
    assert [animation.name for animation in gltf.animations] == [f"{pair.title}, trial {pair.trial}"]
    assert gltf.nodes[gltf.scenes[0].nodes[0]].name == "limbcal"
    assert gltf.buffers[0].byteLength == len(gltf.binary_blob())


@pytest.mark.parametrize(("moves", "paths"), [(0.0, []), (1e-13, []), (1e-3, ["rotation"])])
def test_what_stands_still_has_no_animation(tmp_path: Path, pair: Sampled, moves: float, paths: list[str]) -> None:
    (mover,) = pair.movers[:1]
    q = np.zeros_like(mover.q)
    q[:, 1] = np.linspace(0.0, moves, len(q))
    path = tmp_path / "still.glb"
    write_gltf(path, replace(pair, movers=(replace(mover, q=q),)))
    animations = Viewer(path).gltf.animations
    channels = [channel for animation in animations for channel in animation.channels]
    assert [channel.target.path for channel in channels] == paths
    assert len(animations) == min(len(paths), 1)


def test_black_is_black(tmp_path: Path, pair: Sampled) -> None:
    """Up to 0.04045 light goes with the number."""
    (mover,) = pair.movers[:1]
    dark = mover.colours._replace(link=(0, 10, 11))
    path = tmp_path / "dark.glb"
    write_gltf(path, replace(pair, movers=(replace(mover, colours=dark),)))
    colour = Viewer(path).gltf.materials[0].pbrMetallicRoughness.baseColorFactor
    assert colour[:3] == pytest.approx([0.0, 10 / 255 / 12.92, ((11 / 255 + 0.055) / 1.055) ** 2.4], abs=1e-9)


def test_without_its_animation_a_joint_stands_where_the_first_frame_has_it(written: Path, motion: Sampled) -> None:
    viewer, mover = Viewer(written), motion.movers[0]
    root = viewer.pose("limbcal", 0.0)[:3, :3]
    viewer.gltf.animations = []
    frames = axis_frames(mover.arm, mover.q[:1])[0]
    for i in range(mover.arm.n_joint):
        pose = viewer.pose(f"joint {i + 1}", 0.0)
        assert root.T @ pose[:3, 3] == pytest.approx(frames[i, :3, 3], abs=1e-6)
        assert root.T @ pose[:3, :3] == pytest.approx(frames[i, :3, :3], abs=1e-6)
