"""What every effect of the catalogue says of itself."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import Literal

from arm.model import Arm, Effect, Floats, Joint, JointType, Marker, Sensor, Vector3

#: Where an effect acts: it resists one joint's motion; it changes links, joints or gravity; it changes the torque
#: on its way from the controller to the joint; it lies between the angle that is measured and that of the link;
#: it changes what a sensor reads; or where an optical marker is.
Place = Literal["joint", "arm", "drive", "transmission", "sensor", "marker"]

#: What an effect has in an arm file.
Values = Mapping[str, object]
#: Returns the arm that has an effect, in other numbers of the arm itself.
Change = Callable[[Arm, Effect], Arm]
#: Returns by how much a marker has slid on its link, (n_sample, 3) [m], at joint angles (n_sample, n_joint).
Slid = Callable[[Effect, Floats], Floats]
#: Returns what a sensor has in place of ``a`` (n_sample, 3) [m/s^2] at the run's times ``t`` (n_sample,) [s], with
#: its axes (n_sample, 3, 3) as columns in the base frame: ``reading(a, t, axes, parameters)``.
Reading = Callable[[Floats, Floats, Floats, Values], Floats]


#: No instant of a trial's clock is later, which may count from 1970 [s].
LATEST_S = 1e10


@dataclass(frozen=True)
class Parameter:
    """A number of an effect.

    Attributes
    ----------
    name : str
        It carries its unit, such as ``stiffness_N_m_rad``.
    unit : str
        At a joint that turns, see `unit_at`.
    low, high : float
        What it may be.
    linear : bool
        The torque, or what a sensor reads, is linear in it, the others given.
    neutral : float, optional
        With it the effect does nothing, whatever its other numbers are (of several such, all must be neutral).
        An arm file may have it even where it is infinite.
    optional : bool
        It may be left out.
    several : bool
        It is a list of trials: whole numbers, or names.
    """

    name: str
    unit: str
    low: float
    high: float
    linear: bool = False
    neutral: float | None = None
    optional: bool = False
    several: bool = False

    @property
    def is_phase(self) -> bool:
        """Whether it is the phase of a wave, an angle whatever the joint does."""
        return self.name == "phase_rad"

    def unit_at(self, joint: JointType) -> str:
        """Return its unit at a joint of a type: one that slides goes metres where others turn by radians."""
        if joint == "revolute" or self.is_phase:
            return self.unit
        return self.unit.replace("kg m^2", "kg").replace("N m", "N").replace("rad", "m")


@dataclass(frozen=True)
class EffectKind:
    """One entry of the catalogue.

    Attributes
    ----------
    name : str
    sentence : str
        What it is, in plain words, after "…, because".
    place : {"joint", "arm", "drive", "transmission", "sensor", "marker"}
    parameters : tuple of Parameter
        Of each joint or sensor that it acts on.
    taken_for : tuple of str
        Other effects that look like it in some data.
    whole : bool
        It acts on the arm as a whole: it has neither joints nor sensors nor markers.
    base : str
        Beginning of the names of the base parameters that are the same, such as ``D``; empty where none is.
    holds : bool
        It holds a joint at rest by more than Coulomb friction does.
    event : bool
        It acts at certain times only.
    usual : bool
        Standard models of robots have it (Swevers, Verdonck and De Schutter 2007): before any data it is as likely
        as not.
    is_living : bool
        Only a living body has it: a diagnosis seeks it in arms with a ``[body]`` alone.
    stated_at : str
        The parameter at which others are stated, which is no freedom: a diagnosis takes the end of the range that
        the motion reaches on its side. Empty where there is none.
    exactly : int, optional
        On how many joints, sensors or markers it acts at once; any number where it is absent.
    torque : callable, optional
        For those that act at a joint: a C function of `arm.effects.joint_torque`, the torque with which the joint
        resists, of those of its parameters that are single numbers.
    simulated : mapping of int to str
        For those that a simulation knows as numbers of a joint: where in `arm.effects.joint_numbers`, and which
        parameter that is.
    tip_mass : str
        The parameter that is a mass at the tip; empty where none is.
    change : callable, optional
        For those that are other numbers of the arm, of its joints or its sensors: returns the arm that has it.
    absolute : bool
        What it changes, it states: two of them do not add up.
    marked : callable, optional
        For those that are other markers of the arm: returns the arm that has it in a trial in which it acts.
    slid : callable, optional
        For those by which a marker moves on its link: returns by how much, (n_sample, 3) [m], at some angles.
    late : str
        The parameter that is a delay of a sensor's readings; empty where none is.
    force, reading, converted : callable, optional
        For those that change what sensors read: what acts on the specific force that a sensor feels, on what it
        makes of it, and on that once it has its noise.
    """

    name: str
    sentence: str
    place: Place
    parameters: tuple[Parameter, ...]
    taken_for: tuple[str, ...] = ()
    whole: bool = False
    base: str = ""
    holds: bool = False
    event: bool = False
    usual: bool = False
    is_living: bool = False
    stated_at: str = ""
    exactly: int | None = None
    torque: Callable[..., float] | None = None
    simulated: Mapping[int, str] = field(default_factory=dict, compare=False)
    tip_mass: str = ""
    change: Change | None = None
    absolute: bool = False
    marked: Change | None = None
    slid: Slid | None = None
    late: str = ""
    force: Reading | None = None
    reading: Reading | None = None
    converted: Reading | None = None

    @property
    def numbers(self) -> tuple[Parameter, ...]:
        """Its parameters that are single numbers."""
        return tuple(parameter for parameter in self.parameters if not parameter.several)

    @property
    def acts_on(self) -> str:
        """What an entry in an arm file lists: ``joints``, ``sensors`` or ``markers``; ``arm`` where nothing."""
        return "arm" if self.whole else {"sensor": "sensors", "marker": "markers"}.get(self.place, "joints")


def number(values: Values, name: str) -> float:
    """Return a parameter as a float."""
    value = values[name]
    assert isinstance(value, Real)
    return float(value)


def vector(values: Values, *names: str) -> Vector3:
    """Return three parameters as a vector."""
    x, y, z = (number(values, name) for name in names)
    return x, y, z


def total(a: Vector3, b: Vector3) -> Vector3:
    """Return ``a + b``."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def with_joints(arm: Arm, which: Sequence[int], change: Callable[[Joint], Joint]) -> Arm:
    """Return the arm with some of its joints, counted from 1, changed."""
    joints = (change(joint) if number in which else joint for number, joint in enumerate(arm.joints, 1))
    return replace(arm, joints=tuple(joints))


def with_sensors(arm: Arm, which: Sequence[str], change: Callable[[Sensor], Sensor]) -> Arm:
    """Return the arm with some of its sensors changed."""
    sensors = (change(sensor) if sensor.name in which else sensor for sensor in arm.sensors)
    return replace(arm, sensors=tuple(sensors))


def with_markers(arm: Arm, which: Sequence[str], change: Callable[[Marker], Marker]) -> Arm:
    """Return the arm with some of its markers changed."""
    markers = (change(marker) if marker.name in which else marker for marker in arm.markers)
    return replace(arm, markers=tuple(markers))
