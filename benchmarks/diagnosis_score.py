"""A diagnosis held against the truth, as the issue counts: names, joints, intervals, variables."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

Fields = dict[str, Any]

#: An interval of 95 % reaches this many standard errors to either side.
REACH = 1.96
#: A number that comes without a standard error must be right to this share of it.
EXACT = 1e-3
#: When a payload was taken up must be right to this; no interval is asked for.
SINCE_S = 0.25


def score(truth: Mapping[str, Any], found: Mapping[str, Any], reach: float = REACH) -> Fields:
    """Say what of a diagnosis is right.

    Parameters
    ----------
    truth : mapping
        As `benchmarks.hidden_arms.cases` writes it.
    found : mapping
        The document of ``fitter diagnose --json``.
    reach : float
        Standard errors within which a parameter must be.

    Returns
    -------
    dict
        ``right`` for the kind of the case; ``answer``, what it was taken for; ``class_size``, how many causes were
        held to be equal; and where an effect was named rightly ``joint``, and of its parameters ``inside`` and
        ``asked``. An effect counts as named where a cause is that ``confusable`` declares its equal: then its
        parameters are not asked for.
    """
    verdict, causes = str(found["verdict"]), [one for cause in found["causes"] for one in _single(cause)]
    named = sorted({str(cause["effect"]) for cause in causes})
    answer = verdict if verdict in ("none", "unexplained") else " + ".join(named)
    equal = (
        len({(cause["effect"], *(cause.get("joints") or ())) for cause in causes}) if verdict == "ambiguous" else 1
    )
    scored: Fields = {"verdict": verdict, "answer": answer, "class_size": equal}
    hidden = [str(effect["effect"]) for effect in truth["effects"]]
    if truth["kind"] == "nothing":
        return scored | {"right": verdict == "none"}
    if truth["kind"] == "outside":
        return scored | _variables(truth["effects"][0]["variables"], verdict, found)
    answered = verdict in ("named", "ambiguous")
    taken = [name if name in named else _equal(name, named, found) for name in hidden]
    scored["found"] = [name is not None and answered for name in taken]
    scored["right"] = all(scored["found"]) and (verdict == "ambiguous" or set(named) == set(taken))
    if taken != hidden:
        scored["class_size"] = max(equal, 2)
    parts = [
        _effect(effect, name, causes, verdict, reach)
        for effect, name in zip(truth["effects"], taken, strict=True)
        if answered and name is not None
    ]
    if parts:
        scored["joint"] = all(part["joint"] for part in parts)
        scored["inside"], scored["asked"] = (sum(part[name] for part in parts) for name in ("inside", "asked"))
        scored["outliers"] = [outlier for part in parts for outlier in part["outliers"]]
    return scored


def _equal(name: str, named: list[str], found: Mapping[str, Any]) -> str | None:
    """Return the effect among those named that is declared the equal of one; None if there is none."""
    pairs = [set(pair) for pair in found.get("confusable", ())]
    return next((other for other in named if {name, other} in pairs), None)


def _single(cause: Mapping[str, Any]) -> list[Fields]:
    """Return several pushes that are reported as one cause, their parameters numbered, as a cause each."""
    numbered: dict[str, Fields] = {}
    for name, part in cause["parameters"].items():
        stem, _, number = name.rpartition("_")
        if not number.isdigit():
            return [dict(cause)]
        numbered.setdefault(number, {})[stem] = part
    return [{**cause, "parameters": parameters} for parameters in numbered.values()] or [dict(cause)]


def _variables(true: list[str], verdict: str, found: Mapping[str, Any]) -> Fields:
    """Hold the variables of what stays unexplained against the true ones; a sign counts as its variable."""
    said = {_bare(str(name)) for name in found["residual"]["depends_on"]}
    wanted = {_bare(name) for name in true}
    complete, more = wanted <= said, len(said - wanted)
    return {
        "variables": complete,
        "more_variables": more,
        "right": verdict == "unexplained" and complete and more <= 1,
    }


def _bare(name: str) -> str:
    return name.removeprefix("sign(").removesuffix(")").strip()


def _effect(
    effect: Mapping[str, Any], name: str, causes: Sequence[Mapping[str, Any]], verdict: str, reach: float
) -> Fields:
    """Hold joints and parameters of one effect, rightly named by its own or an equal's name, against the truth.

    The joints are those of one cause or, of several with the same name, of all; among equals the right one counts.
    """
    own = [cause for cause in causes if cause["effect"] == name]
    places, wanted = [set(cause.get("joints") or ()) for cause in own], set(effect["joints"])
    equals = verdict == "ambiguous" and wanted in places
    joint = equals or set().union(*places) == wanted or not wanted
    own = [cause for cause, place in zip(own, places, strict=True) if place == wanted] or own
    scored: Fields = {"joint": joint, "inside": 0, "asked": 0, "outliers": []}
    if not joint or name != effect["effect"]:
        return scored
    for entry in effect["entries"]:
        best = min(own, key=lambda cause: _distance(entry["parameters"], cause["parameters"]))
        for parameter, true in _comparable(entry["parameters"]).items():
            scored["asked"] += 1
            estimates = _comparable({key: part["value"] for key, part in best["parameters"].items()})
            if parameter not in estimates:
                scored["outliers"].append(f"{parameter} is missing, truth {true:.6g}")
                continue
            estimate, std = estimates[parameter], best["parameters"][parameter].get("std")
            inside = abs(_off(parameter, estimate, true)) <= (reach * std if std else EXACT * abs(true))
            scored["inside"] += inside
            if not inside:
                said = f"{estimate:.6g} +- {std:.2g}" if std else f"{estimate:.6g}"
                scored["outliers"].append(f"{parameter}: {said}, truth {true:.6g}")
    return scored


def _comparable(parameters: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers of an effect; a ripple of negative amplitude is one of the opposite phase."""
    numbers = {
        name: float(x) for name, x in parameters.items() if isinstance(x, int | float) and name != "since_s"
    }
    if numbers.get("amplitude_N_m", 1.0) < 0.0 and "phase_rad" in numbers:
        numbers["amplitude_N_m"] *= -1.0
        numbers["phase_rad"] += math.pi
    return numbers


def _off(name: str, estimate: float, true: float) -> float:
    off = estimate - true
    return math.remainder(off, 2.0 * math.pi) if name == "phase_rad" else off


def _distance(true: Mapping[str, Any], found: Mapping[str, Mapping[str, Any]]) -> float:
    """Tell which of several causes of one name a true one is: the one that begins, or is, nearest."""
    if "start_s" in true and "start_s" in found:
        return abs(float(found["start_s"]["value"]) - float(true["start_s"]))
    return 0.0


def payload_placed(truth: Mapping[str, Any], found: Mapping[str, Any]) -> bool | None:
    """Say whether the trials with a payload, or the time since it is there, were found; None without a payload."""
    hidden = [effect["entries"][0]["parameters"] for effect in truth["effects"] if effect["effect"] == "payload"]
    own = [cause["parameters"] for cause in found["causes"] if cause["effect"] == "payload"]
    if not hidden or not own:
        return None
    where = {name: own[0].get(name, {}).get("value") for name in ("trials", "since_s")}
    if "trials" in hidden[0]:
        return sorted(where["trials"] or ()) == sorted(hidden[0]["trials"])
    return where["since_s"] is not None and abs(where["since_s"] - hidden[0]["since_s"]) < SINCE_S
