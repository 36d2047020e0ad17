"""What an arm is: joints, links, sensors, and what is known of its control."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Vector3 = tuple[float, float, float]
JointType = Literal["revolute", "prismatic"]
Law = Literal["pd", "pda", "p", "measured"]

STANDARD_GRAVITY_M_S2 = 9.80665


@dataclass(frozen=True)
class Friction:
    """Friction of one joint: ``viscous*dq + coulomb*sgn(dq)``, and a static level that must be overcome."""

    viscous_N_m_s: float = 0.0
    coulomb_N_m: float = 0.0
    static_N_m: float = 0.0


@dataclass(frozen=True)
class Link:
    """Inertial parameters of one link, in its joint-axis frame (origin on the axis, x along the link).

    ``inertia_kg_m2`` is xx, yy, zz, xy, xz, yz about the frame's origin, not about the centre of mass.
    ``air_drag_N_m_s2`` resists the link's turning in space.
    """

    mass_kg: float = 0.0
    com_m: Vector3 = (0.0, 0.0, 0.0)
    inertia_kg_m2: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    air_drag_N_m_s2: float | None = None


@dataclass(frozen=True)
class Joint:
    """One joint with its link, placed by eq. (1). A prismatic joint's variable is added to ``d_m``.

    ``length_std_m`` says how well ``a_m`` and ``d_m`` are known; without it they may be mere guesses. ``limits``
    are the least and greatest position [rad or m] that the joint can take. ``parent``, counted from 1, is the link
    that the joint hangs on, 0 the base; without it, the link before. ``parent_position_m`` says where on that
    link, in its joint-axis frame; without it, at its far end, or in the origin of frame 0.
    """

    type: JointType = "revolute"
    alpha_rad: float = 0.0
    a_m: float = 0.0
    d_m: float = 0.0
    beta_rad: float = 0.0
    theta_offset_rad: float = 0.0
    length_std_m: float | None = None
    limits: tuple[float, float] | None = None
    parent: int | None = None
    parent_position_m: Vector3 | None = None
    friction: Friction = Friction()
    link: Link = Link()


@dataclass(frozen=True)
class Gyroscope:
    """A triaxial gyroscope in the housing of an accelerometer.

    It reads ``scale * omega + bias_rad_s``, omega being the angular velocity of the link in the sensor's axes.
    """

    scale: Vector3 = (1.0, 1.0, 1.0)
    bias_rad_s: Vector3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Sensor:
    """A triaxial accelerometer riding on a link. ``joint`` counts from 1, as in the arm file.

    It reads ``scale * f + bias_m_s2``, f being the specific force in its own axes. One that is AC-coupled forgets
    whatever lasts much longer than ``1 / (2 pi highpass_hz)``; 0 is a sensor that forgets nothing. A gyroscope may
    share its housing and so its axes.
    """

    name: str
    joint: int
    position_m: Vector3 = (0.0, 0.0, 0.0)
    rotation_rad: Vector3 = (0.0, 0.0, 0.0)
    scale: Vector3 = (1.0, 1.0, 1.0)
    bias_m_s2: Vector3 = (0.0, 0.0, 0.0)
    highpass_hz: float = 0.0
    gyroscope: Gyroscope | None = None


@dataclass(frozen=True)
class SensorCovariance:
    """How well sensors are known that were calibrated, and which of their errors hang together.

    Attributes
    ----------
    parameters : tuple of str
        Sensor and number, such as ``s1 scale_x``: bias, scale, turn [rad] about the sensor's axes and place [m]
        along the link's.
    covariance : tuple of rows
        Lower triangle: the first row has one number, the last one as many as there are parameters.
    """

    parameters: tuple[str, ...]
    covariance: tuple[tuple[float, ...], ...]

    def matrix(self) -> Floats:
        """Return the covariance, (n_parameter, n_parameter)."""
        lower = np.zeros((len(self.parameters),) * 2)
        for k, row in enumerate(self.covariance):
            lower[k, : len(row)] = row
        return lower + np.tril(lower, -1).T


@dataclass(frozen=True)
class Tip:
    """What measures r*: a sensor's dead-reckoned position plus a known offset in the link's frame."""

    sensor: str
    offset_m: Vector3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Estimate:
    """A number that was learnt, with its standard error."""

    value: float
    std: float = float("nan")


@dataclass(frozen=True)
class Effect:
    """What a diagnosis added to the simulation.

    ``joints``, counted from 1, ``sensors`` and ``markers`` say on what it acts; one of the arm as a whole has none
    of them.
    """

    name: str
    parameters: Mapping[str, object] = field(default_factory=dict)
    joints: tuple[int, ...] = ()
    sensors: tuple[str, ...] = ()
    markers: tuple[str, ...] = ()


@dataclass(frozen=True)
class Control:
    """Eq. (5), (6), (7): ``tau = kp (ref - q) + kv dq + ka ddq``; one gain a joint."""

    law: Law = "measured"
    kp: tuple[float, ...] = ()
    kv: tuple[float, ...] = ()
    ka: tuple[float, ...] = ()


@dataclass(frozen=True)
class Base:
    """Where frame 0 stands: in the world, or on the tracked segment that carries it.

    ``rotation_rad`` is roll, pitch and yaw, world to frame 0.
    """

    position_m: Vector3 = (0.0, 0.0, 0.0)
    rotation_rad: Vector3 = (0.0, 0.0, 0.0)
    segment: str | None = None


@dataclass(frozen=True)
class Marker:
    """An optical marker on a link; ``joint`` counts from 1, and 0 is the base.

    ``std_m`` is how far skin and glue let it wander; ``landmark`` the bony point that it is on, such as
    ``medial_malleolus_right``.
    """

    name: str
    joint: int
    position_m: Vector3 = (0.0, 0.0, 0.0)
    std_m: float | None = None
    landmark: str | None = None


@dataclass(frozen=True)
class Body:
    """Whose arm or leg it is."""

    preset: str
    mass_kg: float
    height_m: float
    sex: Literal["f", "m"]


@dataclass(frozen=True)
class Arm:
    """A tree of links, what rides on it, and what was learnt of it. Most are serial chains.

    Every joint comes after the one whose link it hangs on, so that a loop from first to last meets parents first.
    """

    name: str
    joints: tuple[Joint, ...]
    gravity_m_s2: Vector3 = (0.0, 0.0, -STANDARD_GRAVITY_M_S2)
    sensors: tuple[Sensor, ...] = ()
    tip: Tip | None = None
    base_parameters: Mapping[str, Estimate] = field(default_factory=dict)
    effects: tuple[Effect, ...] = ()
    control: Control = Control()
    sensor_covariance: SensorCovariance | None = None
    base: Base | None = None
    markers: tuple[Marker, ...] = ()
    body: Body | None = None

    @property
    def n_joint(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def parents(self) -> tuple[int, ...]:
        """The link that each joint hangs on, from 0; -1: the base."""
        return tuple(i - 1 if joint.parent is None else joint.parent - 1 for i, joint in enumerate(self.joints))

    @property
    def is_serial(self) -> bool:
        """Whether every joint hangs at the far end of the link before it."""
        ends = [(0.0, 0.0, 0.0), *((joint.a_m, 0.0, 0.0) for joint in self.joints)]
        return all(
            parent == i - 1 and joint.parent_position_m in (None, end)
            for i, (joint, parent, end) in enumerate(zip(self.joints, self.parents, ends, strict=False))
        )

    def way_to(self, link: int) -> tuple[int, ...]:
        """Return the links from the base to ``link`` and itself, from 0; none to the base, which is -1."""
        return () if link < 0 else (*self.way_to(self.parents[link]), link)

    @property
    def gyroscopes(self) -> tuple[int, ...]:
        """Which sensors have a gyroscope, from 0."""
        return tuple(s for s, sensor in enumerate(self.sensors) if sensor.gyroscope is not None)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of what is read: of all accelerometers, ``s1x s1y s1z s2x ...``, then of gyroscopes, ``s1gx``."""
        names = [sensor.name for sensor in self.sensors]
        names += [f"{names[s]}g" for s in self.gyroscopes]
        return tuple(f"{name}{axis}" for name in names for axis in "xyz")

    @property
    def n_channel(self) -> int:
        """Number of channels: three an accelerometer and three a gyroscope."""
        return 3 * len(self.sensors) + 3 * len(self.gyroscopes)

    def with_gyroscopes(self, names: Collection[str]) -> "Arm":
        """Return a copy in which these sensors have a gyroscope and no others; an ideal one if none is known."""
        sensors = [
            replace(sensor, gyroscope=(sensor.gyroscope or Gyroscope()) if sensor.name in names else None)
            for sensor in self.sensors
        ]
        return replace(self, sensors=tuple(sensors))

    def sensor_index(self, name: str) -> int:
        """Return the place of a sensor in ``sensors``.

        Raises
        ------
        KeyError
            If no sensor has this name.
        """
        for index, sensor in enumerate(self.sensors):
            if sensor.name == name:
                return index
        raise KeyError(name)

    def with_joints(self, **columns: Floats) -> "Arm":
        """Return a copy whose joints take new geometry, one array a field, such as ``a_m=[0.25, 0.3]``."""
        joints = [
            replace(joint, **{name: float(values[i]) for name, values in columns.items()})  # type: ignore[arg-type]
            for i, joint in enumerate(self.joints)
        ]
        return replace(self, joints=tuple(joints))
