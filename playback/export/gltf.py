"""A sampled motion as glTF 2.0: a node a joint, meshes on it, and one animation."""

from pathlib import Path

import numpy as np
import pygltflib
from numpy.typing import NDArray

from arm.kinematics import local_frames, rotation_from_rpy
from arm.model import Arm
from playback.export.gltf_buffer import GltfBuffer
from playback.export.gravity import upward
from playback.export.rotation import quaternion_between, quaternions
from playback.export.sampled import Mover, Sampled
from playback.export.whole_file import whole_file
from playback.shape import Mesh, Rgb, base_mesh, link_meshes, sensor_mesh
from playback.trajectory import Floats

UP = np.array([0.0, 1.0, 0.0])  # glTF 2.0, 3.3: +Y is up
TWIN_OPACITY = 0.55
STILL = 1e-12  # what a joint does not do by more than this needs no channel


def write_gltf(path: Path, motion: Sampled) -> None:
    """Write ``.glb``, or ``.gltf`` with everything inside.

    Every arm is a node under one root, which turns the arm's upward into glTF's. Below it a chain of nodes
    ``joint 1`` to ``joint n``, each in its joint-axis frame, with the link's mesh; a sensor is a child of its
    link's node, ``tip`` one of the last. Names of a twin end in `` (twin)``.

    Raises
    ------
    DeviceError
        If the disk fails.
    """
    document = _Document(motion)
    gltf = document.finish()
    with whole_file(path) as part:
        if path.suffix.lower() == ".glb":
            gltf.save_binary(part)
        else:
            gltf.convert_buffers(pygltflib.BufferFormat.DATAURI)
            gltf.save_json(part)


class _Document:
    """A glTF document as it grows."""

    def __init__(self, motion: Sampled) -> None:
        self._motion = motion
        self._gltf = pygltflib.GLTF2(asset=pygltflib.Asset(version="2.0", generator="limbcal"))
        self._buffer = GltfBuffer(self._gltf)
        self._times = self._buffer.floats(motion.t[:, None], bounds=True)
        self._animation = pygltflib.Animation(name=f"{motion.title}, trial {motion.trial}")

    def finish(self) -> pygltflib.GLTF2:
        arms = [self._arm(mover, k > 0) for k, mover in enumerate(self._motion.movers)]
        turn = quaternion_between(upward(self._motion.movers[0].arm), UP)
        root = self._node("limbcal", rotation=turn, children=arms)
        self._gltf.scenes = [pygltflib.Scene(name=self._motion.title, nodes=[root])]
        self._gltf.scene = 0
        if self._animation.channels:
            self._gltf.animations = [self._animation]
        self._buffer.close()
        return self._gltf

    def _arm(self, mover: Mover, twin: bool) -> int:
        opacity = TWIN_OPACITY if twin else 1.0
        suffix = " (twin)" if twin else ""
        colours = mover.colours
        link, base, sensor = (
            self._material(f"{name}{suffix}", rgb, opacity)
            for name, rgb in (("link", colours.link), ("base", colours.base), ("sensor", colours.sensor))
        )
        arm, local = mover.arm, local_frames(mover.posed, mover.q)
        tip = self._node(f"tip{suffix}", translation=np.array([arm.joints[-1].a_m, 0.0, 0.0]))
        children: dict[int, list[int]] = {i: [] for i in range(-1, arm.n_joint)}  # of the base and of every link
        children[arm.n_joint - 1].append(tip)
        for i, mesh in reversed(list(enumerate(link_meshes(arm)))):
            for k, rider in enumerate(arm.sensors):
                if rider.joint == i + 1:
                    children[i].append(self._sensor(arm, k, sensor, suffix))
            joint = self._joint(f"joint {i + 1}{suffix}", local[:, i], self._mesh(mesh, link), children[i])
            children[arm.parents[i]].append(joint)
        return self._node(mover.name, mesh=self._mesh(base_mesh(arm), base), children=children[-1])

    def _joint(self, name: str, poses: Floats, mesh: int, children: list[int]) -> int:
        rotation, translation = quaternions(poses[:, :3, :3]), poses[:, :3, 3]
        node = self._node(name, mesh, rotation[0], translation[0], children)
        for path, values in (("rotation", rotation), ("translation", translation)):
            if np.ptp(values, axis=0).max() > STILL:
                sampler = pygltflib.AnimationSampler(
                    input=self._times, output=self._buffer.floats(values), interpolation=pygltflib.ANIM_LINEAR
                )
                target = pygltflib.AnimationChannelTarget(node=node, path=path)
                self._animation.channels.append(
                    pygltflib.AnimationChannel(sampler=len(self._animation.samplers), target=target)
                )
                self._animation.samplers.append(sampler)
        return node

    def _sensor(self, arm: Arm, index: int, material: int, suffix: str) -> int:
        sensor, mesh = arm.sensors[index], sensor_mesh(arm, arm.sensors[index])
        turn, place = rotation_from_rpy(*sensor.rotation_rad), np.array(sensor.position_m)
        own = Mesh((mesh.vertices - place) @ turn, mesh.faces)
        return self._node(f"{sensor.name}{suffix}", self._mesh(own, material), quaternions(turn[None])[0], place)

    def _node(
        self,
        name: str,
        mesh: int | None = None,
        rotation: Floats | None = None,
        translation: Floats | None = None,
        children: list[int] | None = None,
    ) -> int:
        node = pygltflib.Node(name=name, mesh=mesh, children=children or [])
        node.rotation = None if rotation is None else rotation.tolist()
        node.translation = None if translation is None else translation.tolist()
        self._gltf.nodes.append(node)
        return len(self._gltf.nodes) - 1

    def _mesh(self, mesh: Mesh, material: int) -> int:
        primitive = self._buffer.primitive(mesh)
        primitive.material = material
        self._gltf.meshes.append(pygltflib.Mesh(primitives=[primitive]))
        return len(self._gltf.meshes) - 1

    def _material(self, name: str, colour: Rgb, opacity: float) -> int:
        surface = pygltflib.PbrMetallicRoughness(
            baseColorFactor=[*_linear(np.array(colour) / 255.0).tolist(), opacity],
            metallicFactor=0.1,
            roughnessFactor=0.55,
        )
        mode = pygltflib.OPAQUE if opacity == 1.0 else pygltflib.BLEND
        material = pygltflib.Material(name=name, pbrMetallicRoughness=surface, alphaMode=mode, alphaCutoff=None)
        self._gltf.materials.append(material)
        return len(self._gltf.materials) - 1


def _linear(srgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the linear light of sRGB values, as glTF wants base colours (IEC 61966-2-1)."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
