"""The page of the benchmark: what is kept of a case is all that it needs."""

from typing import Any

from benchmarks.diagnosis_page import brief, page


def line(seed: int, kind: str, hidden: list[str], **fields: Any) -> dict[str, Any]:
    effects = [{"effect": name, "joints": [1], "entries": []} for name in hidden]
    effect = hidden[0] if hidden else None
    return {
        "key": f"{kind}/{effect}/{seed}",
        "kind": kind,
        "seed": seed,
        "effect": effect,
        "commit": "0123abc",
        "truth": {"effects": effects, "arm": {"gravity": [0.0, 0.0, -9.81]}},
        "found": {"verdict": "named", "causes": []},
        **fields,
    }


RIGHT = {"verdict": "named", "answer": "cogging", "class_size": 1, "right": True, "joint": True}
LINES = [
    line(1, "one", ["cogging"], score=RIGHT | {"inside": 2, "asked": 3, "found": [True]}, seconds=20.0),
    line(2, "one", ["payload"], score={"answer": "cogging", "class_size": 1, "right": False, "found": [False]}),
    line(3, "one", ["stribeck"], error="Traceback"),
    line(4, "nothing", [], score={"answer": "none", "class_size": 1, "right": True}, processor_s=4.0),
    line(5, "two", ["cogging", "payload"], score=RIGHT | {"inside": 1, "asked": 1, "found": [True, False]}),
    line(6, "outside", ["soft_wall"], score={"answer": "unexplained", "class_size": 1, "right": True}),
]


def test_a_page_is_made_of_what_is_kept() -> None:
    kept = [brief(one) for one in LINES]
    assert page(kept) == page(LINES)
    assert not any("found" in one or "arm" in one["truth"] for one in kept)


def test_a_crash_counts_as_wrong_and_is_counted() -> None:
    text = page(LINES)
    assert "| right name, or its equivalence class | 95 % | 33.3 % of 3 |" in text
    assert "| crashed | 0 | 1 of 6 |" in text
    assert "commits 0123abc" in text


def test_how_long_it_takes_is_told_of_the_newest_code() -> None:
    before = line(7, "one", ["cogging"], score=RIGHT, commit="89abcde", seconds=99.0)
    assert "(newest code, 6) | 60 | 20.00, 20.00 |" in page([before, *LINES])
