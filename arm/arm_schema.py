"""The fields of `arm.toml` (schema 1), what each may be, and the mistakes a file makes against them."""

import math
from collections.abc import Callable, Collection
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from arm.body.limbs import BODY, LIMBS
from arm.body.tracked_segments import TRACKED_SEGMENTS
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


def _whole(value: object) -> object:
    if type(value) is not int:  # true and 1.0 equal 1
        raise ValueError("input should be 1")
    return value


def _standard_error(std: float) -> float:
    if std < 0.0 or math.isinf(std):
        raise ValueError("expected a finite number not below 0; left out where it is not known")
    return std


def _one_of(names: Collection[str]) -> Callable[[str], str]:
    def known(name: str) -> str:
        if name not in names:
            raise ValueError(f"expected one of {', '.join(names)}{did_you_mean(name, names)}")
        return name

    return known


Name = Annotated[str, Field(min_length=1, max_length=_LONGEST_NAME), AfterValidator(_printable)]
Vector = tuple[Number, Number, Number]
Factor = Annotated[Number, Field(gt=0.0)]


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
    segment: Annotated[str, AfterValidator(_one_of(TRACKED_SEGMENTS))] | None = None


class _Marker(_Table):
    name: Name
    joint: Annotated[int, Field(strict=True, ge=0)]
    position_m: Vector = (0.0, 0.0, 0.0)
    std_m: Annotated[Number, Field(ge=0.0)] | None = None
    landmark: Name | None = None


class _Body(_Table):
    preset: Annotated[str, AfterValidator(_one_of((*LIMBS, BODY)))]
    mass_kg: Factor
    height_m: Factor
    sex: Literal["f", "m"]


class _Estimate(_Table):
    value: Number
    std: Annotated[float, Field(strict=True), AfterValidator(_standard_error)] = float("nan")


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

    schema_version: Annotated[Literal[1], BeforeValidator(_whole), Field(alias="schema")]
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
