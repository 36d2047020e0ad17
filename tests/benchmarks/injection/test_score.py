"""Scores of injected recordings: what the machine has of its own counts neither for nor against."""

from typing import Any

import pytest

from arm.model import Effect
from benchmarks.injection.score import score, score_nothing
from tests.benchmarks.injection.test_effects import RUBBING, RUNS

INJECTED = Effect("torque_offset", {"torque_N_m": 0.2}, (2,))


def cause(effect: str, joint: int, name: str, value: float, std: float = 0.01) -> dict[str, Any]:
    return {"effect": effect, "joints": [joint], "parameters": {name: {"value": value, "std": std, "unit": "N m"}}}


def line(*causes: dict[str, Any], verdict: str = "named", confusable: tuple[tuple[str, str], ...] = ()) -> Any:
    found = {"verdict": verdict, "causes": list(causes), "confusable": [list(pair) for pair in confusable]}
    return {"found": found, "friction": [[0.0, 0.0], [0.0, 0.0]]}


def scored(answer: Any, *own: Any) -> Any:
    return score(answer, INJECTED, RUBBING, RUNS, own or (line(verdict="none"),))


def offset(value: float, joint: int = 2) -> dict[str, Any]:
    return cause("torque_offset", joint, "torque_N_m", value)


def test_name_joint_and_size_are_right() -> None:
    result = scored(line(offset(0.21)))
    assert result["right"] and result["name"] and not result["wrong"]
    assert result["ratio"] == pytest.approx(1.05)
    assert result["std"] == pytest.approx(0.05)


def test_a_size_outside_its_interval_is_not_right() -> None:
    result = scored(line(offset(0.25)))
    assert result["name"] and result["size"] is False and not result["right"]


def test_another_joint_or_name_is_wrong() -> None:
    result = scored(line(offset(0.2, joint=1), cause("load_friction", 2, "coefficient", 0.1)))
    assert not result["name"]
    assert result["wrong"] == [["load_friction", [2]], ["torque_offset", [1]]]


def test_a_declared_equal_is_right_by_the_torque_that_it_makes() -> None:
    equal = cause("coulomb_asymmetry", 2, "difference_N_m", -0.2)
    assert not scored(line(equal))["right"]
    assert scored(line(equal, confusable=(("coulomb_asymmetry", "torque_offset"),)))["right"]
    assert scored(line(equal, offset(0.2), verdict="ambiguous"))["right"]


def test_the_machines_own_causes_are_not_wrong_and_their_size_is_taken_off() -> None:
    rotor = cause("rotor_inertia", 2, "inertia_kg_m2", 0.003)
    own = line(rotor, offset(-0.1))
    result = scored(line(rotor, offset(0.1)), own)
    assert result["right"] and result["ratio"] == pytest.approx(1.0)
    assert not scored(line(rotor, offset(-0.1)), own)["name"]


def test_pushes_numbered_in_one_cause_count_each() -> None:
    push = Effect("external_push", {"start_s": 21.0, "duration_s": 0.4, "torque_N_m": 1.0}, (1,))
    numbers = {"start_s_1": 21.0, "duration_s_1": 0.4, "torque_N_m_1": 1.0, "start_s_2": 12.0, "duration_s_2": 0.1}
    parameters = {name: {"value": value, "std": 0.01} for name, value in (numbers | {"torque_N_m_2": 0.3}).items()}
    found = {"effect": "external_push", "joints": [1], "parameters": parameters}
    result = score(line(found), push, RUBBING, RUNS, (line(verdict="none"),))
    assert result["right"] and result["ratio"] == pytest.approx(1.0)


def test_of_nothing_injected_a_name_is_wrong_that_all_runs_dont_have() -> None:
    assert score_nothing(line(offset(0.1)), line(offset(0.2))) == {"wrong": []}
    assert score_nothing(line(offset(0.1)), line(verdict="none")) == {"wrong": [["torque_offset", [2]]]}


def test_the_trial_of_a_push_is_no_number_of_it() -> None:
    numbers = {"start_s": RUNS[0].t[0], "duration_s": 0.2, "torque_N_m": 1.0}
    parameters = {name: {"value": value, "std": 0.01, "unit": ""} for name, value in numbers.items()}
    parameters["trial"] = {"value": RUNS[0].name, "std": None, "unit": ""}
    push = {"effect": "external_push", "joints": [2], "parameters": parameters}
    assert scored(line(offset(0.2), push))["wrong"] == [["external_push", [2]]]
