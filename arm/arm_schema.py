"""The fields of `arm.toml` (schema 1), what each may be, and the mistakes a file makes against them."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from arm.model import (
    STANDARD_GRAVITY_M_S2,
    Arm,
    Control,
    Effect,
    Estimate,
    Friction,
    Joint,
    JointType,
    Law,
    Link,
    Sensor,
    Tip,
)

Number = Annotated[float, Field(allow_inf_nan=False)]
Vector = tuple[Number, Number, Number]


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


class _Joint(_Table):
    type: JointType = "revolute"
    alpha_rad: Number = 0.0
    a_m: Number = 0.0
    d_m: Number = 0.0
    beta_rad: Number = 0.0
    theta_offset_rad: Number = 0.0
    friction: _Friction = _Friction()
    link: _Link = _Link()


class _Sensor(_Table):
    name: Annotated[str, Field(min_length=1)]
    joint: Annotated[int, Field(ge=1)]
    position_m: Vector = (0.0, 0.0, 0.0)
    rotation_rad: Vector = (0.0, 0.0, 0.0)


class _Tip(_Table):
    sensor: str
    offset_m: Vector = (0.0, 0.0, 0.0)


class _Estimate(_Table):
    value: Number
    std: float = float("nan")


class _Effect(_Table):
    name: str
    parameters: dict[str, object] = {}


class _Control(_Table):
    law: Law = "measured"
    kp: tuple[Number, ...] = ()
    kv: tuple[Number, ...] = ()
    ka: tuple[Number, ...] = ()


class ArmTable(_Table):
    """The whole file."""

    schema_version: Annotated[Literal[1], Field(alias="schema")]
    name: str
    gravity_m_s2: Vector = (0.0, 0.0, -STANDARD_GRAVITY_M_S2)
    joint: Annotated[tuple[_Joint, ...], Field(min_length=1)]
    sensor: tuple[_Sensor, ...] = ()
    tip: _Tip | None = None
    base_parameters: dict[str, _Estimate] = {}
    effect: tuple[_Effect, ...] = ()
    control: _Control = _Control()

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
            sensors=tuple(Sensor(**sensor.model_dump()) for sensor in self.sensor),
            tip=None if self.tip is None else Tip(**self.tip.model_dump()),
            base_parameters={name: Estimate(**e.model_dump()) for name, e in self.base_parameters.items()},
            effects=tuple(Effect(**effect.model_dump()) for effect in self.effect),
            control=Control(**self.control.model_dump()),
        )


def mistakes_of(error: ValidationError, where: str) -> list[str]:
    """Return one sentence a mistake: file, field, what was found, what was expected."""
    sentences = []
    for mistake in error.errors():
        field = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in mistake["loc"]).lstrip(
            "."
        )
        if mistake["type"] == "extra_forbidden":
            sentences.append(f"{where}: {field} is not a known field")
        elif mistake["type"] == "missing":
            sentences.append(f"{where}: {field} is missing")
        else:
            expected = mistake["msg"][0].lower() + mistake["msg"][1:]
            sentences.append(f"{where}: {field} is {mistake['input']!r}; {expected}")
    return sentences


def contradictions(table: ArmTable, where: str) -> list[str]:
    """Return what each field allows but the file as a whole does not."""
    n_joint = len(table.joint)
    names = [sensor.name for sensor in table.sensor]
    sentences = [
        f"{where}: sensor[{k}].joint is {sensor.joint}, expected 1 to {n_joint}"
        for k, sensor in enumerate(table.sensor)
        if sensor.joint > n_joint
    ]
    sentences += [
        f"{where}: sensor[{k}].name is {name!r}, which sensor[{names.index(name)}] has already"
        for k, name in enumerate(names)
        if names.index(name) < k
    ]
    if table.tip is not None and table.tip.sensor not in names:
        sentences.append(
            f"{where}: tip.sensor is {table.tip.sensor!r}, expected one of {', '.join(names) or 'no sensor'}"
        )
    needed = {"pd": ("kp", "kv"), "pda": ("kp", "kv", "ka"), "p": ("kp",), "measured": ()}[table.control.law]
    for gain in needed:
        found = len(getattr(table.control, gain))
        if found != n_joint:
            sentences.append(f"{where}: control.{gain} has {found} numbers, expected one a joint ({n_joint})")
    return sentences
