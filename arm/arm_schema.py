"""The fields of `arm.toml` (schema 1), what each may be, and the mistakes a file makes against them."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from arm.effects.check import mistakes_in
from arm.model import (
    STANDARD_GRAVITY_M_S2,
    Arm,
    Base,
    Body,
    Control,
    Effect,
    Estimate,
    Friction,
    Gyroscope,
    Joint,
    JointType,
    Law,
    Link,
    Marker,
    Sensor,
    SensorCovariance,
    Tip,
)
from arm.schema_fields import fields_at
from arm.sensor_covariance import mistakes_of_covariance
from limbcal.suggestion import did_you_mean

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]  # neither "1.0" nor true is a number
#: Characters of a name, which becomes part of file names and of the device's channels.
_LONGEST_NAME = 64


def _printable(name: str) -> str:
    if not name.isprintable():
        raise ValueError("expected only characters that can be printed")
    if "/" in name or "\\" in name:
        raise ValueError("expected no / and no \\, since it becomes part of a file's name")
    return name


def _for_a_file(name: str) -> str:
    if name.startswith("."):
        raise ValueError("expected no dot at its beginning, since it becomes the beginning of a file's name")
    return name


Name = Annotated[str, Field(min_length=1, max_length=_LONGEST_NAME), AfterValidator(_printable)]
Vector = tuple[Number, Number, Number]
Factor = Annotated[Number, Field(gt=0.0)]
#: The gains that each law needs.
_GAINS = {"pd": ("kp", "kv"), "pda": ("kp", "kv", "ka"), "p": ("kp",)}


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class _Friction(_Table):
    viscous_N_m_s: Number = 0.0
    coulomb_N_m: Number = 0.0
    static_N_m: Number = 0.0


class _Link(_Table):
    mass_kg: Number = 0.0
    com_m: Vector = (0.0, 0.0, 0.0)
    inertia_kg_m2: tuple[Number, Number, Number, Number, Number, Number] = (0.0,) * 6
    air_drag_N_m_s2: Annotated[Number, Field(ge=0.0)] | None = None


class _Joint(_Table):
    type: JointType = "revolute"
    alpha_rad: Number = 0.0
    a_m: Number = 0.0
    d_m: Number = 0.0
    beta_rad: Number = 0.0
    theta_offset_rad: Number = 0.0
    length_std_m: Annotated[Number, Field(ge=0.0)] | None = None
    limits: tuple[Number, Number] | None = None
    parent: Annotated[int, Field(strict=True, ge=0)] | None = None
    parent_position_m: Vector | None = None
    friction: _Friction = _Friction()
    link: _Link = _Link()


class _Gyroscope(_Table):
    scale: tuple[Factor, Factor, Factor] = (1.0, 1.0, 1.0)
    bias_rad_s: Vector = (0.0, 0.0, 0.0)


class _Sensor(_Table):
    name: Name
    joint: Annotated[int, Field(strict=True, ge=1)]
    position_m: Vector = (0.0, 0.0, 0.0)
    rotation_rad: Vector = (0.0, 0.0, 0.0)
    scale: tuple[Factor, Factor, Factor] = (1.0, 1.0, 1.0)
    bias_m_s2: Vector = (0.0, 0.0, 0.0)
    highpass_hz: Annotated[Number, Field(ge=0.0)] = 0.0
    gyroscope: _Gyroscope | None = None

    def sensor(self) -> Sensor:
        """Return the sensor of this table."""
        fields = self.model_dump()
        known = fields.pop("gyroscope")
        return Sensor(**fields, gyroscope=None if known is None else Gyroscope(**known))


class _SensorCovariance(_Table):
    parameters: tuple[str, ...]
    covariance: tuple[tuple[Number, ...], ...]


class _Tip(_Table):
    sensor: str
    offset_m: Vector = (0.0, 0.0, 0.0)


class _Base(_Table):
    position_m: Vector = (0.0, 0.0, 0.0)
    rotation_rad: Vector = (0.0, 0.0, 0.0)
    segment: Name | None = None


class _Marker(_Table):
    name: Name
    joint: Annotated[int, Field(strict=True, ge=0)]
    position_m: Vector = (0.0, 0.0, 0.0)
    std_m: Annotated[Number, Field(ge=0.0)] | None = None
    landmark: Name | None = None


class _Body(_Table):
    preset: Name
    mass_kg: Factor
    height_m: Factor
    sex: Literal["f", "m"]


class _Estimate(_Table):
    value: Number
    std: Annotated[float, Field(strict=True)] = float("nan")


class _Effect(_Table):
    name: str
    joints: tuple[Annotated[int, Field(strict=True)], ...] = ()
    sensors: tuple[str, ...] = ()
    markers: tuple[str, ...] = ()
    parameters: dict[str, object] = {}


class _Control(_Table):
    law: Law = "measured"
    kp: tuple[Number, ...] = ()
    kv: tuple[Number, ...] = ()
    ka: tuple[Number, ...] = ()


class ArmTable(_Table):
    """The whole file."""

    schema_version: Annotated[Literal[1], Field(alias="schema")]
    name: Annotated[Name, AfterValidator(_for_a_file)]
    gravity_m_s2: Vector = (0.0, 0.0, -STANDARD_GRAVITY_M_S2)
    joint: Annotated[tuple[_Joint, ...], Field(min_length=1)]
    sensor: tuple[_Sensor, ...] = ()
    tip: _Tip | None = None
    base_parameters: dict[str, _Estimate] = {}
    effect: tuple[_Effect, ...] = ()
    control: _Control = _Control()
    sensor_covariance: _SensorCovariance | None = None
    base: _Base | None = None
    marker: tuple[_Marker, ...] = ()
    body: _Body | None = None

    def arm(self) -> Arm:
        """Return the arm that the file describes."""
        return Arm(
            name=self.name,
            gravity_m_s2=self.gravity_m_s2,
            joints=tuple(
                Joint(
                    **joint.model_dump(exclude={"friction", "link"}),
                    friction=Friction(**joint.friction.model_dump()),
                    link=Link(**joint.link.model_dump()),
                )
                for joint in self.joint
            ),
            sensors=tuple(sensor.sensor() for sensor in self.sensor),
            tip=None if self.tip is None else Tip(**self.tip.model_dump()),
            base_parameters={name: Estimate(**e.model_dump()) for name, e in self.base_parameters.items()},
            effects=tuple(Effect(**effect.model_dump()) for effect in self.effect),
            control=Control(**self.control.model_dump()),
            sensor_covariance=self._sensor_covariance(),
            base=None if self.base is None else Base(**self.base.model_dump()),
            markers=tuple(Marker(**marker.model_dump()) for marker in self.marker),
            body=None if self.body is None else Body(**self.body.model_dump()),
        )

    def _sensor_covariance(self) -> SensorCovariance | None:
        known = self.sensor_covariance
        return None if known is None else SensorCovariance(known.parameters, known.covariance)


def mistakes_of(error: ValidationError, where: str, schema: type[BaseModel]) -> list[str]:
    """Return one sentence a mistake: file, field, what was found, what was expected.

    Parameters
    ----------
    error : ValidationError
    where : str
        The file.
    schema : type
        What the whole file was held against; it knows the fields that may have been meant.
    """
    sentences = []
    mistakes = error.errors()
    inside = {mistake["loc"][:n] for mistake in mistakes for n in range(len(mistake["loc"]))}
    for mistake in mistakes:
        if mistake["type"] == "too_short" and mistake["loc"] in inside:
            continue  # the items are there, but wrong: that is said of each
        field = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in mistake["loc"]).lstrip(
            "."
        )
        if mistake["type"] == "extra_forbidden":
            *table, name = mistake["loc"]
            sentences.append(
                f"{where}: {field} is not a known field{did_you_mean(str(name), fields_at(schema, table))}"
            )
        elif mistake["type"] == "missing":
            sentences.append(f"{where}: {field} is missing")
        elif mistake["type"] == "model_type":
            sentences.append(f"{where}: {field} is {mistake['input']!r}; input should be a table")
        else:
            said = mistake["msg"].removeprefix("Value error, ")
            expected = said[0].lower() + said[1:]
            sentences.append(f"{where}: {field} is {mistake['input']!r}; {expected}")
    return sentences


def contradictions(raw: Mapping[str, Any], where: str) -> list[str]:
    """Return what each field allows but the file as a whole does not.

    It looks at the file as it was read, so that these mistakes are named beside those in single fields; what has
    the wrong type is passed over here.
    """
    n_joint = len(_tables(raw.get("joint")))
    sensors = _tables(raw.get("sensor"))
    names = [sensor.get("name") for sensor in sensors]
    sentences = _riding(sensors, "sensor", 1, n_joint, where)
    sentences += _riding(_tables(raw.get("marker")), "marker", 0, n_joint, where)
    for k, joint in enumerate(_tables(raw.get("joint"))):
        parent = joint.get("parent")
        if type(parent) is int and parent > k:
            expected = "0, the base" if k == 0 else f"0 to {k}, the base or an earlier link"
            sentences.append(f"{where}: joint[{k}].parent is {parent}, expected {expected}")
        match joint.get("limits"):
            case [int() | float() as least, int() | float() as most] if not least < most:
                sentences.append(f"{where}: joint[{k}].limits is {[least, most]}, expected the least one first")
    tip, known = raw.get("tip"), [name for name in names if isinstance(name, str)]
    if isinstance(tip, dict) and isinstance(tip.get("sensor"), str) and tip["sensor"] not in known:
        sentences.append(
            f"{where}: tip.sensor is {tip['sensor']!r}, expected one of {', '.join(known) or 'no sensor'}"
        )
    sentences += [f"{where}: {one}" for one in mistakes_of_covariance(raw.get("sensor_covariance"), known)]
    effects = _tables(raw.get("effect"))
    markers = [name for one in _tables(raw.get("marker")) if isinstance(name := one.get("name"), str)]
    sentences += [f"{where}: {mistake}" for mistake in mistakes_in(effects, n_joint, known, markers)]
    control = raw.get("control")
    if isinstance(control, dict) and n_joint:
        for gain in _GAINS.get(str(control.get("law")), ()):
            given = control.get(gain, [])
            if isinstance(given, list) and len(given) != n_joint:
                sentences.append(
                    f"{where}: control.{gain} has {len(given)} numbers, expected one a joint ({n_joint})"
                )
    return sentences


def _riding(tables: list[dict[str, Any]], kind: str, least: int, n_joint: int, where: str) -> list[str]:
    """Return the mistakes in where sensors or markers ride, and in their names."""
    names = [table.get("name") for table in tables]
    sentences = [
        f"{where}: {kind}[{k}].joint is {table['joint']}, expected {least} to {n_joint}"
        for k, table in enumerate(tables)
        if isinstance(table.get("joint"), int) and table["joint"] > n_joint > 0
    ]
    sentences += [
        f"{where}: {kind}[{k}].name is {name!r}, which {kind}[{names.index(name)}] has already"
        for k, name in enumerate(names)
        if isinstance(name, str) and names.index(name) < k
    ]
    return sentences


def _tables(value: object) -> list[dict[str, Any]]:
    """Return an array of tables; what is none of it counts as an empty table."""
    return [item if isinstance(item, dict) else {} for item in value] if isinstance(value, list) else []
