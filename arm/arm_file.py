"""`arm.toml`: reading, with every mistake named, and writing."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from arm.arm_schema import ArmTable, mistakes_of
from arm.body.limbs import BODY, LIMBS, MEAN_PERSON, limb
from arm.model import Arm, Estimate
from arm.schema_contradictions import contradictions
from limbcal.errors import ConfigError, DeviceError
from limbcal.suggestion import did_you_mean
from limbcal.toml import parse_toml, read_toml_text

_PRESETS = resources.files("arm") / "presets"

#: What an arm file says of its links where a calibration wrote it.
_ONLY_SUMS_ARE_KNOWN = """\
# Motion reveals only sums of the links' masses, first moments and inertias: those in [base_parameters], below.
# Each `link` is one physically possible choice that has these sums; its own numbers were not measured.
"""
_ONE_OF_MANY = "# one choice of many: only [base_parameters] is known"


def preset_names() -> list[str]:
    """Return the names of the built-in arms."""
    return sorted([*(entry.name.removesuffix(".toml") for entry in _PRESETS.iterdir()), *LIMBS, BODY])


def load_arm(source: str | Path) -> Arm:
    """Read an arm by the name of a built-in one or from a file.

    Raises
    ------
    ConfigError
        If there is no such arm, or with every mistake that its file makes.
    """
    if str(source) == BODY:
        from arm.body.whole_body import human_body  # noqa: PLC0415 - a daemon's processes load no compiler for it

        return human_body(replace(MEAN_PERSON, preset=BODY))
    if str(source) in LIMBS:
        return limb(replace(MEAN_PERSON, preset=str(source)))
    if str(source) in preset_names():
        return parse_arm((_PRESETS / f"{source}.toml").read_text(encoding="utf-8"), f"{source}.toml")
    path = Path(source)
    try:
        text = read_toml_text(path)
    except OSError as error:
        known = ", ".join(preset_names()) + did_you_mean(str(source), preset_names())
        expected = f"expected an arm file or one of {known}"
        raise ConfigError(f"arm {str(source)!r}: {error.strerror}; {expected}") from error
    return parse_arm(text, str(source))


def parse_arm(text: str, where: str) -> Arm:
    """Read an arm from the text of its file; ``where`` names the file in what is said of mistakes.

    Raises
    ------
    ConfigError
        With every mistake in the text.
    """
    raw = parse_toml(text, where)
    found = contradictions(raw, where)
    try:
        table = ArmTable.model_validate(raw)
    except ValidationError as error:
        raise ConfigError(mistakes_of(error, where, ArmTable) + found) from error
    if found:
        raise ConfigError(found)
    return table.arm()


def save_arm(arm: Arm, path: Path) -> None:
    """Write an arm file.

    Raises
    ------
    DeviceError
        If the file cannot be written.
    """
    try:
        path.write_text(format_arm(arm), encoding="utf-8")
    except OSError as error:
        raise DeviceError(f"{path}: cannot be written: {error.strerror}") from error


def format_arm(arm: Arm) -> str:
    """Return the text of an arm file; `parse_arm` gives the same arm back."""
    blocks = [_table("", {"schema": 1, "name": arm.name, "gravity_m_s2": arm.gravity_m_s2})]
    joints = [_table("[[joint]]", vars(joint)) for joint in arm.joints]
    if arm.base_parameters:
        blocks.append(_ONLY_SUMS_ARE_KNOWN)
        joints = [_with_comment(joint, "link = ", _ONE_OF_MANY) for joint in joints]
    blocks += joints
    blocks += [_table("[[sensor]]", vars(sensor)) for sensor in arm.sensors]
    if arm.tip is not None:
        blocks.append(_table("[tip]", vars(arm.tip)))
    if arm.sensor_covariance is not None:
        blocks.append(_table("[sensor_covariance]", vars(arm.sensor_covariance)))
    if arm.base_parameters:
        blocks.append(_table("[base_parameters]", {name: _finite(e) for name, e in arm.base_parameters.items()}))
    blocks += [_table("[[effect]]", _given(vars(effect))) for effect in arm.effects]
    blocks += [_table("[base]", vars(arm.base))] if arm.base is not None else []
    blocks += [_table("[[marker]]", vars(marker)) for marker in arm.markers]
    blocks += [_table("[body]", vars(arm.body))] if arm.body is not None else []
    blocks.append(_table("[control]", _given(vars(arm.control))))
    return "\n".join(blocks)


def _with_comment(table: str, beginning: str, comment: str) -> str:
    """Return a table with a comment at the end of the line that begins in some way."""
    lines = table.splitlines()
    return "\n".join(f"{line}  {comment}" if line.startswith(beginning) else line for line in lines) + "\n"


def _given(fields: Mapping[str, object]) -> dict[str, object]:
    return {name: value for name, value in fields.items() if value != ()}


def _finite(estimate: Estimate) -> dict[str, float]:
    return {name: x for name, x in vars(estimate).items() if math.isfinite(x)}


def _table(header: str, fields: Mapping[str, object]) -> str:
    lines = [header] if header else []
    lines += [f"{_key(name)} = {_value(value)}" for name, value in fields.items() if value is not None]
    return "\n".join(lines) + "\n"


def _key(name: str) -> str:
    return name if name.replace("_", "").replace("-", "").isalnum() and name.isascii() else _string(name)


def _value(value: object) -> str:
    if isinstance(value, np.generic):  # a fit hands in numpy's numbers, whose repr is not TOML
        value = value.item()
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(str(k))} = {_value(v)}" for k, v in value.items() if v is not None) + " }"
    if isinstance(value, Iterable):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    return _value(vars(value))


def _string(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped) + '"'
