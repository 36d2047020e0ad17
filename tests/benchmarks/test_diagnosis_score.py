"""Diagnoses held against the truth of simulated cases."""

from typing import Any

import pytest

from benchmarks.diagnosis_score import score
from benchmarks.hidden_arms.cases import Case, draw_case
from benchmarks.hidden_arms.effects import OUTSIDE
from benchmarks.hidden_arms.hiding import Bench

SHORT = Bench(trial_s=3.0, learning=3, evaluating=3)


def answer(case: Case) -> dict[str, Any]:
    """Return the document of a diagnosis that is right in everything."""
    causes = [
        {
            "effect": effect["effect"],
            "joints": entry.get("joints", []),
            "parameters": {name: {"value": x, "std": 0.01, "unit": ""} for name, x in entry["parameters"].items()},
            "support": 1.0,
        }
        for effect in case.truth["effects"]
        for entry in effect["entries"]
    ]
    return {"verdict": "named", "causes": causes, "residual": {"depends_on": []}}


@pytest.mark.parametrize("effect", OUTSIDE)
def test_variables_are_asked_for_of_what_is_in_no_catalogue(effect: str) -> None:
    case = draw_case(43, "outside", effect, SHORT)
    variables = case.truth["effects"][0]["variables"]
    found = {"verdict": "unexplained", "causes": [], "residual": {"depends_on": variables}}
    assert score(case.truth, found)["right"]
    assert not score(case.truth, found | {"verdict": "none"})["right"]
    assert not score(case.truth, found | {"residual": {"depends_on": ["t"]}})["right"]


@pytest.mark.parametrize("effect", ["external_push", "actuator_delay", "payload", "cogging"])
def test_a_right_answer_counts_as_right(effect: str) -> None:
    case = draw_case(44, "one", effect, SHORT)
    found = answer(case)
    result = score(case.truth, found)
    assert result["right"] and result["joint"]
    assert result["inside"] == result["asked"] > 0
    also = found["causes"][0] | {"effect": "viscous"}
    assert not score(case.truth, found | {"causes": [*found["causes"], also]})["right"]
    assert score(case.truth, found | {"causes": [*found["causes"], also], "verdict": "ambiguous"})["right"]
    assert not score(case.truth, found | {"verdict": "none", "causes": []})["right"]


def test_numbered_pushes_count_as_several() -> None:
    case = next(c for c in (draw_case(k, "one", "external_push", SHORT) for k in range(50)) if several(c))
    found = answer(case)
    pushes = [cause["parameters"] for cause in found["causes"]]
    numbered = {f"{name}_{k}": part for k, push in enumerate(pushes, 1) for name, part in push.items()}
    result = score(case.truth, found | {"causes": [found["causes"][0] | {"parameters": numbered}]})
    assert result["right"] and result["joint"]
    assert result["inside"] == result["asked"] == 3 * len(pushes)


def several(case: Case) -> bool:
    return len(case.truth["effects"][0]["entries"]) > 1


def test_equal_joints_are_a_class() -> None:
    case = draw_case(47, "one", "gain_error", SHORT)
    found = answer(case)
    cause = found["causes"][0]
    other = cause | {"joints": [3 - cause["joints"][0]], "parameters": {"factor": {"value": 0.1, "std": 1e-4}}}
    result = score(case.truth, found | {"verdict": "ambiguous", "causes": [other, cause]})
    assert result["right"] and result["joint"]
    assert (result["class_size"], result["inside"], result["asked"]) == (2, 1, 1)
    assert not score(case.truth, found | {"causes": [other]})["joint"]


def test_a_wrong_joint_or_size_is_told() -> None:
    case = draw_case(45, "one", "quadratic_drag", SHORT)
    found = answer(case)
    cause = found["causes"][0]
    assert not score(case.truth, found | {"causes": [cause | {"joints": [9]}]})["joint"]
    off = {"drag_N_m_s2": {"value": 2.0 + cause["parameters"]["drag_N_m_s2"]["value"], "std": 0.5}}
    result = score(case.truth, found | {"causes": [cause | {"parameters": off}]})
    assert (result["inside"], result["asked"], len(result["outliers"])) == (0, 1, 1)


def test_a_declared_equal_counts_as_the_right_name() -> None:
    case = draw_case(47, "one", "torque_offset", SHORT)
    joints = case.truth["effects"][0]["joints"]
    equal = {"effect": "coulomb_asymmetry", "joints": joints, "parameters": {}}
    found = {"verdict": "named", "causes": [equal], "confusable": [["coulomb_asymmetry", "torque_offset"]]}
    result = score(case.truth, found)
    assert result["right"] and result["joint"]
    assert (result["class_size"], result["asked"]) == (2, 0)
    assert not score(case.truth, found | {"confusable": []})["right"]
    assert not score(case.truth, found | {"causes": [equal | {"joints": [9]}]})["joint"]
