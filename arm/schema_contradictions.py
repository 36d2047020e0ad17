"""What each field of `arm.toml` allows but the file as a whole does not."""

from collections.abc import Mapping
from typing import Any

from arm.effects.check import mistakes_in
from arm.sensor_covariance import mistakes_of_covariance

#: The gains that each law needs.
_GAINS = {"pd": ("kp", "kv"), "pda": ("kp", "kv", "ka"), "p": ("kp",)}


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
    known = [name for name in names if isinstance(name, str)]
    sentences += _of_tip(raw.get("tip"), sensors, known, n_joint, where)
    sentences += [f"{where}: {one}" for one in mistakes_of_covariance(raw.get("sensor_covariance"), known)]
    effects = _tables(raw.get("effect"))
    markers = [name for one in _tables(raw.get("marker")) if isinstance(name := one.get("name"), str)]
    sentences += [f"{where}: {mistake}" for mistake in mistakes_in(effects, n_joint, known, markers)]
    sentences += _channels(sensors, where)
    control = raw.get("control")
    if isinstance(control, dict) and n_joint:
        sentences += _gains(control, n_joint, where)
    return sentences


def _gains(control: Mapping[str, Any], n_joint: int, where: str) -> list[str]:
    """Return the gains that are not one a joint: those that the law needs, and all that are given."""
    needed = _GAINS.get(str(control.get("law")), ())
    return [
        f"{where}: control.{name} has {len(given)} numbers, expected one a joint ({n_joint})"
        for name in ("kp", "kv", "ka")
        if isinstance(given := control.get(name, []), list) and len(given) != n_joint and (given or name in needed)
    ]


def _channels(sensors: list[dict[str, Any]], where: str) -> list[str]:
    """Return the sensors whose channels are called as those of another's gyroscope are."""
    names = [sensor.get("name") for sensor in sensors]
    return [
        f"{where}: sensor[{k}].name is {name!r}: so are the channels of the gyroscope of sensor[{other}] called, "
        f"{name}x to {name}z; expected another name"
        for other, sensor in enumerate(sensors)
        if isinstance(sensor.get("gyroscope"), dict) and isinstance(names[other], str)
        for k, name in enumerate(names)
        if name == f"{names[other]}g"
    ]


def _of_tip(tip: object, sensors: list[dict[str, Any]], known: list[str], n_joint: int, where: str) -> list[str]:
    """Return the mistake in what measures the tip: a sensor of the last link, whose far end it is."""
    name = tip.get("sensor") if isinstance(tip, dict) else None
    if not isinstance(name, str):
        return []
    if name not in known:
        return [f"{where}: tip.sensor is {name!r}, expected one of {', '.join(known) or 'no sensor'}"]
    link = next(sensor.get("joint") for sensor in sensors if sensor.get("name") == name)
    if type(link) is not int or link >= n_joint:
        return []
    return [
        f"{where}: tip.sensor is {name!r} on link {link}, expected one on link {n_joint}: the tip is the far end "
        "of the last link"
    ]


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
