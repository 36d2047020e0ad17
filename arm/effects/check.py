"""What an arm's effects must be to be those of the catalogue: every mistake is a sentence."""

from collections.abc import Iterator, Mapping, Sequence
from numbers import Integral, Real
from typing import Any

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import EffectKind, Parameter
from arm.model import Arm
from limbcal.suggestion import did_you_mean

#: Between controller and link a joint has one of each of these at most.
_ONCE = ("drive", "transmission")


def effect_mistakes(arm: Arm) -> list[str]:
    """Return what is wrong with an arm's effects, one sentence a mistake."""
    sensors, markers = [sensor.name for sensor in arm.sensors], [marker.name for marker in arm.markers]
    return list(mistakes_in([vars(effect) for effect in arm.effects], arm.n_joint, sensors, markers))


def mistakes_in(
    effects: Sequence[Mapping[str, Any]], n_joint: int, sensors: Sequence[str], markers: Sequence[str] = ()
) -> Iterator[str]:
    """Yield the mistakes in effects as an arm file has them; what has the wrong type is passed over.

    Parameters
    ----------
    effects : sequence of mapping
        With name, parameters, joints, sensors, markers.
    n_joint : int
    sensors, markers : sequence of str
        Names of the arm's.
    """
    there: set[tuple[str, int]] = set()
    for k, effect in enumerate(effects):
        where, name = f"effect[{k}]", effect.get("name")
        if not isinstance(name, str):
            continue
        kind = catalogue().get(name)
        if kind is None:
            meant = did_you_mean(name, catalogue())
            yield f"{where}.name is {name!r}, expected one of {', '.join(catalogue())}{meant}"
            continue
        yield from _on_what(where, kind, effect, n_joint, {"sensors": sensors, "markers": markers})
        parameters = effect.get("parameters", {})
        if isinstance(parameters, Mapping):
            yield from _numbers(f"{where}.parameters", kind, parameters)
        for joint in _listed(effect, "joints", int) if kind.place in _ONCE else ():
            if (name, joint) in there:
                yield f"{where}: joint {joint} has the effect {name} already"
            there.add((name, joint))


def _on_what(
    where: str, kind: EffectKind, effect: Mapping[str, Any], n_joint: int, riding: Mapping[str, Sequence[str]]
) -> Iterator[str]:
    """Yield what is wrong with an effect's joints, sensors and markers."""
    wanted = "" if kind.whole else kind.acts_on
    for field in ("joints", *riding):
        given = effect.get(field) or []
        if field == wanted and not given:
            yield f"{where}.{field} is missing: {kind.name} acts on {field}"
        elif field == wanted and kind.exactly is not None and len(given) != kind.exactly:
            yield f"{where}.{field} is {given!r}: {kind.name} acts on {kind.exactly} {field} at once"
        elif field != wanted and given:
            on = f"acts on {wanted}" if wanted else "acts on the arm as a whole"
            yield f"{where}.{field} is {given!r}, but {kind.name} {on}"
    if wanted == "joints" and n_joint:
        for joint in _listed(effect, "joints", int):
            if not 1 <= joint <= n_joint:
                yield f"{where}.joints has {joint}, expected 1 to {n_joint}"
    if wanted in riding:
        there = riding[wanted]
        for name in _listed(effect, wanted, str):
            if name not in there:
                yield f"{where}.{wanted} has {name!r}, expected one of {', '.join(there) or f'no {wanted[:-1]}'}"


def _numbers(where: str, kind: EffectKind, values: Mapping[str, Any]) -> Iterator[str]:
    """Yield what is wrong with an effect's parameters."""
    known = {parameter.name: parameter for parameter in kind.parameters}
    for name in values:
        if name not in known:
            yield f"{where}.{name} is not known, expected {', '.join(known)}{did_you_mean(name, known)}"
    for name, parameter in known.items():
        if name in values:
            yield from _number(f"{where}.{name}", parameter, values[name])
        elif not parameter.optional:
            yield f"{where}.{name} is missing"


def _number(where: str, parameter: Parameter, value: object) -> Iterator[str]:
    """Yield what is wrong with one parameter."""
    between = f"from {parameter.low:g} to {parameter.high:g}"
    if parameter.several:
        items: Sequence[Any] = list(value) if isinstance(value, list | tuple | np.ndarray) else [None]
        named = (isinstance(item, str) and item for item in items)
        counted = (_is_whole(item) and parameter.low <= item <= parameter.high for item in items)
        if not all(a or b for a, b in zip(named, counted, strict=True)):
            yield f"{where} is {value!r}, expected a list of whole numbers {between}, or names"
        return
    if not isinstance(value, bool) and isinstance(value, Real):
        number = float(value)
        if number == parameter.neutral or parameter.low <= number <= parameter.high:
            return
    yield f"{where} is {value!r}, expected a number {between}"


def _listed(effect: Mapping[str, Any], field: str, kind: type) -> list[Any]:
    """Return the items of a list that have the right type."""
    given = effect.get(field)
    if not isinstance(given, list | tuple):
        return []
    return [item for item in given if (_is_whole(item) if kind is int else isinstance(item, kind))]


def _is_whole(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)
