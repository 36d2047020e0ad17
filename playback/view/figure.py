"""One arm in the scene: its links, joint frames, sensors and optical markers."""

import numpy as np
import viser
from viser.transforms import SO3

from arm.effects.effect_table import changed
from arm.model import Arm
from playback.shape import Colours, Mesh, base_mesh, link_meshes, link_poses, reach_m, sensor_mesh
from playback.trajectory import Floats

#: Radius of an optical marker, which is most often a ball of 14 mm [m].
MARKER_RADIUS_M = 0.007


class Figure:
    """An arm under a node of its own; only the links' frames move, all else rides on them.

    Parameters
    ----------
    server : viser.ViserServer
    root : str
        Name of the node, such as ``/real``.
    arm : Arm
    colours : Colours
    opacity : float, optional
        Below 1 the arm is seen through.
    """

    def __init__(
        self, server: viser.ViserServer, root: str, arm: Arm, colours: Colours, opacity: float | None = None
    ) -> None:
        self.arm, self._posed = arm, changed(arm)
        self._scene, self._opacity = server.scene, opacity
        reach = reach_m(arm)
        self._root = server.scene.add_frame(root, show_axes=False)
        self._mesh(f"{root}/base", base_mesh(arm), colours.base)
        self._links, self._axes = [], []
        for index, mesh in enumerate(link_meshes(arm)):
            name = f"{root}/link{index + 1}"
            self._links.append(server.scene.add_frame(name, show_axes=False))
            self._mesh(f"{name}/body", mesh, colours.link)
            length = 0.2 * reach
            self._axes.append(
                server.scene.add_frame(
                    f"{name}/axes", axes_length=length, axes_radius=0.025 * length, origin_radius=0.05 * length
                )
            )
        self._sensors: list[viser.MeshHandle | viser.IcosphereHandle] = []
        self._labels: list[viser.LabelHandle] = []
        for sensor in arm.sensors:
            name = f"{root}/link{sensor.joint}/{sensor.name}"
            self._sensors.append(self._mesh(name, sensor_mesh(arm, sensor), colours.sensor))
            above = np.array(sensor.position_m) + np.array([0.0, 0.0, 0.08 * reach])
            self._labels.append(
                server.scene.add_label(
                    f"{root}/link{sensor.joint}/label {sensor.name}",
                    sensor.name,
                    position=tuple(above),
                    font_screen_scale=0.75,
                    anchor="bottom-center",
                )
            )
        for marker in arm.markers:
            node = f"{root}/link{marker.joint}" if marker.joint else root
            self._sensors.append(
                server.scene.add_icosphere(
                    f"{node}/marker {marker.name}",
                    radius=MARKER_RADIUS_M,
                    color=colours.sensor,
                    opacity=opacity,
                    position=marker.position_m,
                )
            )
        self.show(np.zeros(arm.n_joint))

    def show(self, q: Floats) -> None:
        """Move the arm to joint values, (n_joint,) [rad or m]."""
        poses = link_poses(self._posed, q[None])[0]
        for link, pose, wxyz in zip(self._links, poses, SO3.from_matrix(poses[:, :3, :3]).wxyz, strict=True):
            link.position = pose[:3, 3]
            link.wxyz = wxyz

    def stand_at(self, place: Floats) -> None:
        """Put the arm's base somewhere, (3,) [m]."""
        self._root.position = place

    def seen(self, arm: bool = True, sensors: bool = True, labels: bool = True, axes: bool = True) -> None:
        """Say what of it is to be seen."""
        self._root.visible = arm
        for handle in self._sensors:
            handle.visible = sensors
        for label in self._labels:
            label.visible = labels and sensors
        for frame in self._axes:
            frame.visible = axes

    def remove(self) -> None:
        """Take the arm off the scene."""
        self._root.remove()

    def _mesh(self, name: str, mesh: Mesh, colour: tuple[int, int, int]) -> viser.MeshHandle:
        return self._scene.add_mesh_simple(
            name,
            mesh.vertices,
            mesh.faces,
            color=colour,
            opacity=self._opacity,
            flat_shading=True,
            cast_shadow=self._opacity is None,
        )
