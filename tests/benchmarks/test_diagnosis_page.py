"""The page of the benchmark, of one commit's lines."""

from typing import Any

from benchmarks.diagnosis_page import page, wrong_ones


def line(seed: int, kind: str, hidden: list[str], **fields: Any) -> dict[str, Any]:
    effect = hidden[0] if hidden else None
    return {
        "key": f"{kind}/{effect}/{seed}",
        "kind": kind,
        "seed": seed,
        "effect": effect,
        "commit": "0123abc",
        "hidden": [{"effect": name, "joints": [1]} for name in hidden],
        "said": "named: cogging 1 (amplitude_N_m 0.1)",
        **fields,
    }


RIGHT = {"verdict": "named", "answer": "cogging", "class_size": 1, "right": True, "joint": True}
LINES = [
    line(1, "one", ["cogging"], score=RIGHT | {"inside": 2, "asked": 3, "outliers": ["phase_rad: 1, truth 2"]}),
    line(2, "one", ["payload"], score={"answer": "cogging", "class_size": 1, "right": False, "found": [False]}),
    line(3, "one", ["stribeck"], error="Traceback\nValueError: no"),
    line(4, "nothing", [], score={"answer": "none", "class_size": 1, "right": True}, processor_s=4.0),
    line(5, "two", ["cogging", "payload"], score=RIGHT | {"inside": 1, "asked": 1, "found": [True, False]}),
    line(6, "outside", ["soft_wall"], score={"answer": "unexplained", "class_size": 1, "right": True}),
]


def test_a_crash_counts_as_wrong_and_is_counted() -> None:
    text = page(LINES)
    assert "| right name, or its equivalence class | 98.5 % | 33.3 % of 3 |" in text
    assert "| crashed | 0 | 1 of 6 |" in text
    assert "all of commit 0123abc" in text


def test_what_is_wrong_is_listed_with_what_was_said() -> None:
    text = wrong_ones(LINES)
    assert "| 2 | payload 1 | wrong | named: cogging 1 (amplitude_N_m 0.1) |" in text
    assert "| 3 | stribeck 1 | crashed | ValueError: no |" in text
    assert "| 1 | cogging 1 | size | phase_rad: 1, truth 2 |" in text
    assert "| 4 |" not in text


def test_where_nothing_is_wrong_nothing_is_listed() -> None:
    assert wrong_ones(LINES[3:4]) == "Nothing.\n"
