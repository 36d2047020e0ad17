"""The page of the diagnosis benchmark: goals, what went wrong where, and the confusion matrix."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

Line = dict[str, Any]

OPENING = """# Causes found, of those that were hidden

Every case is an arm drawn at random, simulated by code that is not the fitter's (`benchmarks/hidden_arms`: another
integrator, another step, other equations), with noise of 2e-4 rad and 1 % of the torque. What is hidden leaves
4 to 15 % of the torque unexplained by the best base model, static friction apart. The diagnosis sees five learning
and seventeen evaluating trials of 6.75 s and an arm file with lengths, gravity and, in half of the cases, the
control law. A case that crashes counts as wrong.
"""


def page(lines: Sequence[Line]) -> str:
    """Return the page in Markdown.

    Parameters
    ----------
    lines : sequence of dict
        Those of one results file.
    """
    parts = [OPENING, _ran(lines), figures(lines)]
    one = [line for line in lines if line["kind"] in ("one", "nothing")]
    if one:
        parts += ["## Effect by effect\n", by_effect(one), "## Confusion matrix\n", confusion(one)]
    for kind, title in (("two", "## Two at once\n"), ("outside", "## Effects that are in no catalogue\n")):
        chosen = [line for line in lines if line["kind"] == kind]
        if chosen:
            parts += [title, by_effect(chosen) if kind == "outside" else pairs(chosen)]
    return "\n".join([*parts, "## What was wrong\n", wrong_ones(lines)])


def _ran(lines: Sequence[Line]) -> str:
    """Return what the page is made of."""
    kinds = Counter(str(line["kind"]) for line in lines)
    counts = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    seeds = {kind: [line["seed"] for line in lines if line["kind"] == kind] for kind in kinds}
    spans = ", ".join(f"{min(some)} to {max(some)}" for some in seeds.values())
    commit = lines[0]["commit"]
    return (
        f"This page is made of {len(lines)} cases ({counts}), of the seeds {spans}, all of commit {commit}: "
        f"`python -m benchmarks.diagnosis --page benchmarks/results/diagnosis-{commit}.jsonl`.\n"
    )


def figures(lines: Sequence[Line]) -> str:
    """Return the table of the goals, those that the lines say something of."""
    kinds = ("one", "nothing", "two", "outside")
    scores = {kind: [_score(x) for x in lines if x["kind"] == kind] for kind in kinds}
    rows: list[tuple[str, str, str]] = []
    if one := scores["one"]:
        named = [s for s in one if s.get("right")]
        asked = sum(s.get("asked", 0) for s in named)
        inside = sum(s.get("inside", 0) for s in named)
        rows += [
            ("right name, or its equivalence class", "98.5 %", _share(s.get("right") for s in one)),
            ("… of these as one of a class", "", _share(s["class_size"] > 1 for s in named)),
            ("right joint, given the right name", "98 %", _share(s.get("joint") for s in named)),
            (f"true parameter inside its 95 % interval, of {asked}", "93 %", _part(inside, asked)),
        ]
    if nothing := scores["nothing"]:
        rows.append(("nothing hidden, nothing named", "99 %", _share(s.get("right") for s in nothing)))
    if two := scores["two"]:
        rows += [
            ("two hidden, both named", "90 %", _share(s.get("right") for s in two)),
            ("… at least one of them", "", _share(any(s.get("found", [])) for s in two)),
        ]
    if outside := scores["outside"]:
        rows += [
            (
                "outside the catalogue: `unexplained`, right variables",
                "88 %",
                _share(s.get("right") for s in outside),
            ),
            ("… `unexplained`", "", _share(s.get("verdict") == "unexplained" for s in outside)),
        ]
    took = [line["seconds"] for line in lines if "seconds" in line]
    used = [line["processor_s"] for line in lines if "processor_s" in line]
    rows += [
        ("seconds a diagnosis: median, longest", "30", f"{_quantile(took, 0.5)}, {_quantile(took, 1.0)}"),
        ("… of processor", "", f"{_quantile(used, 0.5)}, {_quantile(used, 1.0)}"),
        ("crashed", "0", f"{sum('error' in line for line in lines)} of {len(lines)}"),
    ]
    return table(("", "goal", "measured"), rows)


def wrong_ones(lines: Sequence[Line]) -> str:
    """Return a row for each case that is wrong, or has a number outside its interval: what was said of it."""
    rows = []
    for line in lines:
        s = _score(line)
        parts = [f"{one['effect']} {','.join(map(str, one['joints']))}" for one in line.get("hidden", [])]
        hidden = "; ".join(parts)
        where = (line["seed"], hidden or line["effect"] or line["kind"])
        if "error" in line:
            rows.append((*where, "crashed", str(line["error"]).strip().splitlines()[-1]))
        elif not s.get("right"):
            rows.append((*where, "wrong", line["said"]))
        elif not s.get("joint", True):
            rows.append((*where, "joint", line["said"]))
        elif s.get("outliers"):
            rows.append((*where, "size", "; ".join(s["outliers"])))
    return table(("seed", "hidden", "wrong", "said"), rows) if rows else "Nothing.\n"


def by_effect(lines: Sequence[Line]) -> str:
    """Return a row an effect: how often it was named, and for what it was taken."""
    rows = []
    for effect in _effects(lines):
        chosen = [line for line in lines if _name(line) == effect]
        scores = [_score(line) for line in chosen]
        wrong = Counter(str(s.get("answer", "crashed")) for s in scores if not s.get("right"))
        named = [s for s in scores if s.get("right")]
        asked = sum(s.get("asked", 0) for s in named)
        rows.append(
            (
                effect,
                len(chosen),
                len(named),
                sum(s["class_size"] > 1 for s in named),
                sum(bool(s.get("joint")) for s in named) if asked else "-",
                f"{sum(s.get('inside', 0) for s in named)} / {asked}" if asked else "-",
                ", ".join(f"{answer} {count}" for answer, count in wrong.most_common()),
            )
        )
    header = ("hidden", "cases", "right", "in a class", "joint", "in interval", "taken for")
    return table(header, rows)


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
    return table(("hidden \\ answered", *(number[answer] for answer in answers)), rows)


def pairs(lines: Sequence[Line]) -> str:
    """Return how often each effect was found in company of another."""
    named: dict[str, list[bool]] = {}
    for line in lines:
        effects = line.get("hidden", [])
        found = _score(line).get("found", [False] * len(effects))
        for effect, there in zip(effects, found, strict=True):
            named.setdefault(str(effect["effect"]), []).append(bool(there))
    rows = [(name, len(found), sum(found)) for name, found in sorted(named.items())]
    return table(("one of two", "cases", "named"), rows)


def _score(line: Line) -> dict[str, Any]:
    return dict(line.get("score", {}))


def _name(line: Line) -> str:
    effects = line.get("hidden", [])
    return str(effects[0]["effect"]) if effects else str(line["effect"] or line["kind"])


def _effects(lines: Sequence[Line]) -> list[str]:
    names = {_name(line) for line in lines}
    return [*sorted(names - {"nothing"}), *sorted(names & {"nothing"})]


def _share(each: Any) -> str:
    values = [bool(x) for x in each]
    return f"{100.0 * sum(values) / len(values):.1f} % of {len(values)}" if values else "-"


def _part(some: int, of: int) -> str:
    return f"{100.0 * some / of:.1f} %" if of else "-"


def _quantile(values: Sequence[float], share: float) -> str:
    return f"{sorted(values)[min(int(share * len(values)), len(values) - 1)]:.2f}" if values else "-"


def table(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, cells)) + " |" for cells in lines) + "\n"
