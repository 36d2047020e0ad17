"""`limbd.toml`: its fields, the flags that win over them, and every mistake in either."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from arm.arm_file import load_arm, parse_arm
from arm.arm_schema import mistakes_of
from arm.model import Arm, Floats
from daemon.config.config_schema import Config
from limbcal.errors import ConfigError, DataError
from limbcal.toml import parse_toml, read_toml_text
from protocol.curve import needs_keys
from protocol.endpoint import parse_endpoint
from protocol.recording import ARM_ATTACHMENT, CONFIG_ATTACHMENT
from protocol.recording_reader import recording_attachments

Flags = Mapping[str, Mapping[str, object]]

#: Ends the sentence of a run that ends because its device is not there.
WAIT_ADVICE = "`limbd run --wait` waits for it"
#: What a field is called on the command line, for those who have no file.
_FLAG_OF = {"device.port": "--port", "arm.file": "--arm"}


@dataclass(frozen=True)
class Setup:
    """A config whose arm file was read and fits.

    ``replay`` is the recording that is played back in place of a device, if one is, ``speed`` how fast.
    """

    config: Config
    arm: Arm
    replay: Path | None = None
    speed: float = 1.0

    @property
    def initial_q_rad(self) -> Floats | None:
        """Joint angles at the first rest, (n_joint,), where they are given."""
        given = self.config.tracking.initial_q_rad
        return None if given is None else np.array(given)


def load_setup(path: Path | None, flags: Flags) -> Setup:
    """Read the config file, let the flags win over it, and read the arm that it names.

    Parameters
    ----------
    path : Path or None
        The config file; with None the flags must say everything.
    flags : mapping of table to mapping of key to value
        What was given on the command line.

    Raises
    ------
    ConfigError
        With every mistake in the config, the flags and the arm file.
    """
    where = "arguments" if path is None else f"{path} with its flags" if flags else str(path)
    return _setup(where, _with_flags({} if path is None else _read(path), flags))


def replayed_setup(recording: Path, flags: Flags, speed: float) -> Setup:
    """Return the setup of a recorded run, let flags win over it, and publish on this machine, without metrics.

    Parameters
    ----------
    recording : Path
    flags : mapping of table to mapping of key to value
        As in `load_setup`. Nothing is recorded unless they say so.
    speed : float
        Times as fast as it was.

    Raises
    ------
    DataError
        If the recording cannot be read, or has no config or arm attached.
    ConfigError
        As in `load_setup`.
    """
    attached = recording_attachments(recording)
    if missing := {ARM_ATTACHMENT, CONFIG_ATTACHMENT} - set(attached):
        raise DataError(
            f"recording {recording}: {' and '.join(sorted(missing))} are not attached to it, or damaged"
        )
    arm_text, config_text = (
        attached[name].decode(errors="replace") for name in (ARM_ATTACHMENT, CONFIG_ATTACHMENT)
    )
    tables = parse_toml(config_text, f"{CONFIG_ATTACHMENT} in {recording}")
    publish = tables.pop("publish", {})
    raw = {"raw": publish["raw"]} if isinstance(publish, dict) and "raw" in publish else {}
    tables = _with_flags({**tables, "publish": raw, "record": None, "metrics": None}, flags)
    arm = None if "arm" in flags else parse_arm(arm_text, f"{ARM_ATTACHMENT} in {recording}")
    return replace(_setup(str(recording), tables, arm), replay=recording, speed=speed)


def _with_flags(tables: dict[str, object], flags: Flags) -> dict[str, object]:
    merged = {"device": {}, "arm": {}} | tables
    for name, values in flags.items():
        table = merged.get(name)
        merged[name] = {**(table if isinstance(table, dict) else {}), **values}
    return merged


def _setup(where: str, tables: dict[str, object], arm: Arm | None = None) -> Setup:
    mistakes: list[str] = []
    config = None
    try:
        config = Config.model_validate(tables)
    except ValidationError as error:
        mistakes += [_with_flag(sentence) for sentence in mistakes_of(error, where, Config)]
    mistakes += [f"{where}: publish.{mistake}" for mistake in _endpoint_mistakes(tables.get("publish"))]
    arm = arm or _load_arm(tables["arm"], where, mistakes)
    tracking = tables.get("tracking")
    if isinstance(tracking, dict) and "zero" in tracking and tracking.get("method", "filter") == "filter":
        mistakes.append(
            f"{where}: tracking.zero is {tracking['zero']!r}, expected it only with tracking.method = 'integrate'"
        )
    given = _given_angles(tracking)
    if arm is not None and given is not None and given != arm.n_joint:
        mistakes.append(
            f"{where}: tracking.initial_q_rad has {given} numbers, "
            f"expected one a joint of {arm.name!r} ({arm.n_joint})"
        )
    if mistakes:
        raise ConfigError(mistakes)
    assert config is not None
    assert arm is not None
    return Setup(config, arm)


def _endpoint_mistakes(publish: object) -> list[str]:
    """Say what is wrong with where is published, whatever else is wrong with the config."""
    endpoint = publish.get("endpoint") if isinstance(publish, dict) else None
    if not isinstance(publish, dict) or not isinstance(endpoint, str):
        return []  # absent, or named already as a mistake of the field
    try:
        found = parse_endpoint(endpoint)
    except ConfigError as error:
        return error.mistakes
    if found.host is None and found.path is None:
        return [f"endpoint is {endpoint!r}, expected tcp:// or ipc://, which other programs can reach"]
    open_to_all = not found.is_local and publish.get("keys") is None
    return [f"{needs_keys(endpoint)} in publish.keys"] if open_to_all else []


def format_config(config: Config) -> str:
    """Return the config as the TOML text that would give it again, flags included."""
    lines = []
    for name, table in config.model_dump(exclude_none=True).items():
        lines += [f"[{name}]", *(f"{key} = {_value(value)}" for key, value in table.items()), ""]
    return "\n".join(lines)


def _read(path: Path) -> dict[str, object]:
    try:
        return parse_toml(read_toml_text(path), str(path))
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}; expected a limbd config file") from error


def _load_arm(table: object, where: str, mistakes: list[str]) -> Arm | None:
    source = table.get("file") if isinstance(table, dict) else None
    if not isinstance(source, str) or not source:
        return None  # named already as a mistake of the field
    try:
        arm = load_arm(source)
    except ConfigError as error:
        mistakes += error.mistakes
        return None
    if not arm.sensors:
        mistakes.append(f"{where}: arm.file {source!r} has no [[sensor]], expected at least one")
    return arm


def _given_angles(table: object) -> int | None:
    angles = table.get("initial_q_rad") if isinstance(table, dict) else None
    return len(angles) if isinstance(angles, list | tuple) else None


def _with_flag(sentence: str) -> str:
    for field, flag in _FLAG_OF.items():
        if sentence.endswith(f": {field} is missing"):
            return f"{sentence}; expected in the config file or as {flag}"
    return sentence


def _value(value: object) -> str:
    # A JSON string, number, boolean or list of numbers is TOML as well.
    return json.dumps(value, ensure_ascii=False)
