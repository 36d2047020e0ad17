"""Diagnoses of injected recordings, held against what was injected.

A measured machine has causes of its own. Those are the names (effect and joints) that were found in the same
recordings with nothing injected: in the whole set, and with each learning run left out where that was asked for.
Own names count neither for nor against a diagnosis, unless their size has changed.

- *name*: what was injected is among the causes, by its name or by that of an effect which ``confusable`` declares
  its equal (under ``ambiguous`` every cause is declared an equal), at the joint at which it was injected. A name
  that was found without injection too counts if its size has changed by more than its interval.
- *size*: the torques of the causes with that name are compared over the learning runs, while the joint moves, with
  the torque that was injected, by projection: ``found . injected / injected . injected``; what the machine's own
  cause of that name makes is taken from it. It must be 1 within its interval of 95 %: that of the cause's linear
  numbers, and of the own cause's. An effect whose torque needs the arm's masses, such as a turned gravity that is
  named as an equal, is not asked for its size.
- *right*: name and size.
- *wrong*: at least one name is neither injected, nor declared equal to it, nor found without injection. Of nothing
  injected, with a learning run left out: at least one name that is not found with all runs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from arm.effects.catalogue import catalogue
from arm.effects.effect import number
from arm.model import Arm, Effect, Friction
from benchmarks.injection.effects import added_torque, resistance
from benchmarks.injection.runs import Run

Line = dict[str, Any]
Name = tuple[str, tuple[int, ...]]

#: Standard errors to either side of an interval of 95 %.
REACH = 1.96
#: Parameters that say where an effect is there, and have no error.
_PLACES = ("trials", "since_s")


def names_of(line: Line) -> set[Name]:
    """Return effects and joints that a diagnosis names."""
    return {_name(cause) for cause in line["found"]["causes"]}


def _name(cause: Mapping[str, Any]) -> Name:
    return str(cause["effect"]), tuple(cause.get("joints") or ())


def equals_of(name: str, found: Mapping[str, Any]) -> set[str]:
    """Return the effects that a diagnosis declares equal to one, itself among them."""
    pairs = [set(pair) for pair in found.get("confusable", [])]
    equal = {name}.union(*(pair for pair in pairs if name in pair))
    causes = {str(cause["effect"]) for cause in found["causes"]}
    return equal | causes if found["verdict"] == "ambiguous" and name in causes else equal


def score(line: Line, injected: Effect, arm: Arm, runs: Sequence[Run], own: Sequence[Line]) -> Line:
    """Score the diagnosis of one injected set.

    Parameters
    ----------
    line : dict
        Its ``found``, and under ``friction`` viscous and Coulomb friction of the joints of the extended arm.
    injected : Effect
    arm : Arm
        With the friction that thermal drift multiplies.
    runs : sequence of Run
        As recorded.
    own : sequence of dict
        Lines of the same set with nothing injected, that with all runs first.

    Returns
    -------
    dict
        ``name``, ``size`` (None: not asked for), ``right``, ``wrong`` (the wrong names), ``ratio``, its ``std``.
    """
    equal = equals_of(injected.name, line["found"])
    machine = set().union(*(names_of(one) for one in own))
    right_names = {one for one in names_of(line) if one[0] in equal and _at(one[1], injected.joints)}
    wrong = sorted(one for one in names_of(line) - machine if one not in right_names)
    answer: Line = {"name": False, "size": None, "right": False, "ratio": None, "std": None}
    answer["wrong"] = [[effect, list(joints)] for effect, joints in wrong]
    for one in sorted(right_names, key=lambda name: name[0] != injected.name):
        ratio = _ratio(one, line, injected, arm, runs)
        before = _ratio(one, own[0], injected, arm, runs) if own and one in names_of(own[0]) else (0.0, 0.0)
        if ratio is None or before is None:
            if one not in machine:
                answer |= {"name": True, "right": answer["size"] is not False}
            continue
        change, std = ratio[0] - before[0], float(np.hypot(ratio[1], before[1]))
        if one in machine and abs(change) <= REACH * std:
            continue
        size = abs(change - 1.0) <= REACH * std
        answer |= {"name": True, "size": size, "right": size, "ratio": change, "std": std}
        if size:
            break
    return answer


def score_nothing(line: Line, own: Line) -> Line:
    """Score a set in which nothing was injected and from which a learning run was left out."""
    return {"wrong": [[effect, list(joints)] for effect, joints in sorted(names_of(line) - names_of(own))]}


def _at(joints: tuple[int, ...], wanted: tuple[int, ...]) -> bool:
    """Say whether joints are the right ones; an effect of the whole arm is at every joint."""
    return not joints or not wanted or joints == wanted


def _ratio(name: Name, line: Line, injected: Effect, arm: Arm, runs: Sequence[Run]) -> tuple[float, float] | None:
    """Return how large the causes of a name are in units of what was injected, and the standard error of that."""
    kind = catalogue()[name[0]]
    if kind.change is not None and kind.name != "air_drag" or kind.place in ("drive", "transmission"):
        if kind.name != "gain_error":
            return None
    joints = tuple(
        replace(joint, friction=Friction(*friction))
        for joint, friction in zip(arm.joints, line["friction"], strict=True)
    )
    learning = [run for run in runs if run.learning]
    more = [added_torque(arm, injected, run) for run in learning]
    moving = np.concatenate([run.moving for run in learning])
    hidden = np.concatenate(more) * moving

    def projected(effect: Effect) -> float:
        rubbing = replace(arm, joints=joints)
        made = [resistance(rubbing, effect, run, run.tau + one) for run, one in zip(learning, more, strict=True)]
        return float(np.sum(np.concatenate(made) * hidden) / np.sum(hidden**2))

    total, variance = 0.0, 0.0
    for effect, errors in _effects(name, line["found"]["causes"]):
        size = projected(effect)
        total += size
        for parameter, std in errors.items():
            values = {**effect.parameters, parameter: number(effect.parameters, parameter) + std}
            variance += (projected(replace(effect, parameters=values)) - size) ** 2
    return total, float(np.sqrt(variance))


def _effects(name: Name, causes: Sequence[Mapping[str, Any]]) -> list[tuple[Effect, dict[str, float]]]:
    """Return the causes of a name as an arm has them, each with the standard errors of its linear numbers."""
    known = {one.name for one in catalogue()[name[0]].parameters}
    linear = {one.name for one in catalogue()[name[0]].parameters if one.linear}
    found = []
    for cause in causes:
        if _name(cause) != name:
            continue
        for parameters in _single(cause["parameters"]):
            values = {
                key: part["value"]
                for key, part in parameters.items()
                if key in known and part["value"] is not None  # the trial of a push is said beside them
            }
            errors = {key: part["std"] for key, part in parameters.items() if key in linear and part.get("std")}
            found.append((Effect(name[0], values, name[1]), errors))
    return found


def _single(parameters: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the parameters of several pushes that one cause numbers, each by itself."""
    numbered: dict[str, dict[str, Any]] = {}
    for name, part in parameters.items():
        stem, _, at = name.rpartition("_")
        if not at.isdigit() or name in _PLACES:
            return [dict(parameters)]
        numbered.setdefault(at, {})[stem] = part
    return list(numbered.values())
