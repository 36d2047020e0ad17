"""The page of the diagnosis benchmark: goals, what went wrong where, and the confusion matrix."""

import statistics
from collections import Counter
from collections.abc import Sequence
from typing import Any

Line = dict[str, Any]

#: What the page is made of.
_KEPT = ("key", "kind", "seed", "effect", "commit", "score", "seconds", "processor_s", "error")

OPENING = """# Causes found, of those that were hidden

Every case is an arm drawn at random, simulated by code that is not the fitter's (`tests/diagnosis`: another
integrator, another step, other equations), with noise of 2e-4 rad and 1 % of the torque. What is hidden leaves
4 to 15 % of the torque unexplained by the best base model, static friction apart. `fitter diagnose` sees five
learning and seventeen evaluating trials of 6.75 s and an arm file with lengths, gravity and, in half of the cases,
the control law. A case that crashes counts as wrong. "Beside truth" is the torque error of the extended arm in the
evaluating trials, as a multiple of that of a model that was told the effect and its numbers; both are evaluated
below 5 Hz by code that is not the fitter's either. Made by `python -m benchmarks.diagnosis`.
"""


def brief(line: Line) -> Line:
    """Return what the page needs of a case's line; names of what was hidden in place of the whole truth."""
    hidden = [{"effect": one["effect"]} for one in line.get("truth", {}).get("effects", [])]
    return {name: line[name] for name in _KEPT if name in line} | {"truth": {"effects": hidden}}


def page(lines: Sequence[Line]) -> str:
    """Return the page in Markdown.

    Parameters
    ----------
    lines : sequence of dict
        The log's, one a case.
    """
    parts = [OPENING, _ran(lines), goals(lines)]
    one = [line for line in lines if line["kind"] in ("one", "nothing")]
    if one:
        parts += ["## Effect by effect\n", by_effect(one), "## Confusion matrix\n", confusion(one)]
    for kind, title in (("two", "## Two at once\n"), ("outside", "## Effects that are in no catalogue\n")):
        chosen = [line for line in lines if line["kind"] == kind]
        if chosen:
            parts += [title, by_effect(chosen) if kind == "outside" else pairs(chosen)]
    return "\n".join(parts)


def _ran(lines: Sequence[Line]) -> str:
    """Return what the page is made of."""
    kinds = Counter(str(line["kind"]) for line in lines)
    counts = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    seeds = {kind: [line["seed"] for line in lines if line["kind"] == kind] for kind in kinds}
    spans = ", ".join(f"{min(some)} to {max(some)}" for some in seeds.values())
    commits = ", ".join(sorted({str(line["commit"]) for line in lines if "commit" in line}))
    return f"This page is made of {len(lines)} cases ({counts}), of the seeds {spans}; commits {commits}.\n"


def goals(lines: Sequence[Line]) -> str:
    """Return the table of the goals."""
    scores = {
        kind: [_score(x) for x in lines if x["kind"] == kind] for kind in ("one", "nothing", "two", "outside")
    }
    one = scores["one"]
    named = [s for s in one if s.get("right")]
    asked = sum(s.get("asked", 0) for s in named)
    beside = [s["beside_oracle"] for s in named if "beside_oracle" in s]
    rows = [
        ("right name, or its equivalence class", "95 %", _share(s.get("right") for s in one)),
        ("… of these as one of a class", "", _share(s["class_size"] > 1 for s in named)),
        ("… and the size of such a class", "", _mean([s["class_size"] for s in named if s["class_size"] > 1])),
        ("right joint, given the right name", "98 %", _share(s.get("joint") for s in named)),
        (
            f"true parameter inside its 95 % interval ({asked} parameters)",
            "90 %",
            f"{100.0 * sum(s.get('inside', 0) for s in named) / asked:.1f} %" if asked else "-",
        ),
        ("nothing hidden, nothing named", "98 %", _share(s.get("right") for s in scores["nothing"])),
        ("two hidden, both named", "80 %", _share(s.get("right") for s in scores["two"])),
        ("… at least one of them", "", _share(any(s.get("found", [])) for s in scores["two"])),
        (
            "outside the catalogue: `unexplained`, right variables",
            "85 %",
            _share(s.get("right") for s in scores["outside"]),
        ),
        ("… `unexplained`", "", _share(s.get("verdict") == "unexplained" for s in scores["outside"])),
        (
            "evaluating error beside a model that knew the truth, at most 1.1 ×",
            "",
            _share(x <= 1.1 for x in beside),
        ),
        ("… median and 95th percentile", "1.1 ×", f"{_quantile(beside, 0.5)}, {_quantile(beside, 0.95)}"),
    ]
    newest = [line for line in lines if line.get("commit") == lines[-1].get("commit")]
    took = [line["seconds"] for line in newest if "seconds" in line]
    used = [line["processor_s"] for line in newest if "processor_s" in line]
    rows += [
        (
            f"seconds a diagnosis, one process, several at once: median, longest (newest code, {len(newest)})",
            "60",
            f"{_quantile(took, 0.5)}, {_quantile(took, 1.0)}",
        ),
        ("… of them a processor's", "", f"{_quantile(used, 0.5)}, {_quantile(used, 1.0)}"),
        ("crashed", "0", f"{sum('error' in line for line in lines)} of {len(lines)}"),
    ]
    return _table(("", "goal", "measured"), rows)


def by_effect(lines: Sequence[Line]) -> str:
    """Return a row an effect: how often it was named, and for what it was taken."""
    rows = []
    for effect in _effects(lines):
        chosen = [line for line in lines if _name(line) == effect]
        scores = [_score(line) for line in chosen]
        wrong = Counter(str(s.get("answer", "crashed")) for s in scores if not s.get("right"))
        named = [s for s in scores if s.get("right")]
        asked = sum(s.get("asked", 0) for s in named)
        beside = [s["beside_oracle"] for s in named if "beside_oracle" in s]
        rows.append(
            (
                effect,
                len(chosen),
                len(named),
                sum(s["class_size"] > 1 for s in named),
                sum(bool(s.get("joint")) for s in named) if asked else "-",
                f"{sum(s.get('inside', 0) for s in named)} / {asked}" if asked else "-",
                _quantile(beside, 0.5),
                ", ".join(f"{answer} {count}" for answer, count in wrong.most_common()),
            )
        )
    header = ("hidden", "cases", "right", "in a class", "joint", "in interval", "beside truth", "taken for")
    return _table(header, rows)


def confusion(lines: Sequence[Line]) -> str:
    """Return the matrix: rows are what was hidden, columns what was answered, by number."""
    effects = _effects(lines)
    answers = [
        *[e for e in effects if e != "nothing"],
        "a class with it",
        "none",
        "unexplained",
        "other",
        "crashed",
    ]

    def place(line: Line) -> str:
        s = _score(line)
        if "answer" not in s:
            return "crashed"
        if s.get("right") and s["class_size"] > 1:
            return "a class with it"
        return s["answer"] if s["answer"] in answers else "other"

    number = {answer: str(k + 1) if answer in effects else answer for k, answer in enumerate(answers)}
    rows = []
    for effect in effects:
        counts = Counter(place(line) for line in lines if _name(line) == effect)
        label = f"{number[effect]} {effect}" if effect in number else effect
        rows.append((label, *(counts[answer] or "" for answer in answers)))
    return _table(("hidden \\ answered", *(number[answer] for answer in answers)), rows)


def pairs(lines: Sequence[Line]) -> str:
    """Return how often each effect was found beside another."""
    told: dict[str, list[bool]] = {}
    for line in lines:
        effects = line.get("truth", {}).get("effects", [])
        found = _score(line).get("found", [False] * len(effects))
        for effect, there in zip(effects, found, strict=True):
            told.setdefault(str(effect["effect"]), []).append(bool(there))
    rows = [(name, len(found), sum(found)) for name, found in sorted(told.items())]
    return _table(("one of two", "cases", "named"), rows)


def _score(line: Line) -> dict[str, Any]:
    return dict(line.get("score", {}))


def _name(line: Line) -> str:
    effects = line.get("truth", {}).get("effects", [])
    return str(effects[0]["effect"]) if effects else str(line["effect"] or line["kind"])


def _effects(lines: Sequence[Line]) -> list[str]:
    names = {_name(line) for line in lines}
    return [*sorted(names - {"nothing"}), *sorted(names & {"nothing"})]


def _share(told: Any) -> str:
    values = [bool(x) for x in told]
    return f"{100.0 * sum(values) / len(values):.1f} % of {len(values)}" if values else "-"


def _mean(values: Sequence[float]) -> str:
    return f"{statistics.fmean(values):.1f}" if values else "-"


def _quantile(values: Sequence[float], share: float) -> str:
    return f"{sorted(values)[min(int(share * len(values)), len(values) - 1)]:.2f}" if values else "-"


def _table(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, cells)) + " |" for cells in lines) + "\n"
