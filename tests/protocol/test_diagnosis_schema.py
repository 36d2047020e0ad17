"""The schema of a diagnosis, against documents as `fitter diagnose` writes them."""

from typing import Any

import pytest

from protocol.diagnosis_schema import DIAGNOSIS_FIELDS

KINDS = {
    "object": dict,
    "array": list,
    "number": (int, float),
    "integer": int,
    "string": str,
    "boolean": bool,
    "null": type(None),
}


def faults(value: object, schema: dict[str, Any], where: str) -> list[str]:
    """Return where a value is not of its schema, by JSON Schema's own words for types, enums and members."""
    found = []
    kinds = [schema["type"]] if isinstance(schema.get("type"), str) else schema.get("type", [])
    fits = [kind for kind in kinds if isinstance(value, KINDS[kind])]
    if isinstance(value, bool):
        fits = [kind for kind in fits if kind == "boolean"]
    if kinds and not fits or "enum" in schema and value not in schema["enum"]:
        found.append(where)
    if isinstance(value, dict):
        for name, item in value.items():
            part = schema.get("properties", {}).get(name, schema.get("additionalProperties", {}))
            found += faults(item, part, f"{where}.{name}")
    if isinstance(value, list):
        for item in value:
            found += faults(item, schema.get("items", {}), f"{where}[]")
    return found


def errors(**changes: object) -> dict[str, object]:
    angle = {"mean": 0.1, "rms": 0.2, "max": None}
    return {"torque_rms_N_m": [0.1], "torque_rms_unfiltered_N_m": None, "angle_error_deg": angle, **changes}


def document() -> dict[str, Any]:
    """Return a diagnosis as docs/diagnosing.md has it."""
    size = {"value": [0.1, 0.2], "std": None, "unit": "kg"}
    judged = {**errors(), "sets": {"a": errors()}, "trials": {"a#1": errors()}}
    return {
        "verdict": "named",
        "complete": True,
        "left": {"torque_rms_N_m": [0.1], "share": 0.2, "times_noise": 1.1},
        "causes": [
            {
                "effect": "payload",
                "joints": [],
                "parameters": {"mass": size},
                "support": 0.9,
                "takes_away": {"learn": 0.5},
            }
        ],
        "candidates": [{"effect": "payload", "joints": [2], "gain": 0.5, "support": 0.9}],
        "confusable": [["payload", "joint_spring"]],
        "next_experiment": "move faster",
        "before": errors(),
        "after": errors(torque_rms_unfiltered_N_m=[0.2]),
        "gain": {"torque": 0.5, "angle": None, "ci95": [0.4, 0.6]},
        "polished": False,
        "polish": {"before": errors(), "after": errors()},
        "judged": {"before": judged, "after": judged},
        "explained": {},
        "residual": {},
        "structure": {},
        "suspected": [],
        "notes": [{"kind": "gap"}],
    }


def test_a_diagnosis_is_of_its_schema() -> None:
    one = document()
    assert one.keys() == DIAGNOSIS_FIELDS.keys()
    assert faults(one, {"properties": DIAGNOSIS_FIELDS}, "") == []
    assert faults(one | {"polish": None, "judged": None}, {"properties": DIAGNOSIS_FIELDS}, "") == []


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"verdict": "perhaps"}, ".verdict"),
        ({"complete": 1}, ".complete"),
        ({"left": {"share": "half"}}, ".left.share"),
        ({"left": {"torque_rms_N_m": 0.1}}, ".left.torque_rms_N_m"),
        ({"causes": [{"joints": [1.5]}]}, ".causes[].joints[]"),
        ({"causes": [{"parameters": {"mass": {"unit": None}}}]}, ".causes[].parameters.mass.unit"),
        ({"causes": [{"parameters": {"mass": {"std": "small"}}}]}, ".causes[].parameters.mass.std"),
        ({"candidates": [{"gain": None}]}, ".candidates[].gain"),
        ({"next_experiment": None}, ".next_experiment"),
        ({"before": errors(angle_error_deg=0.5)}, ".before.angle_error_deg"),
        ({"after": errors(torque_rms_unfiltered_N_m=["a"])}, ".after.torque_rms_unfiltered_N_m[]"),
        ({"gain": {"torque": None}}, ".gain.torque"),
        ({"gain": {"ci95": 0.5}}, ".gain.ci95"),
        ({"polished": "yes"}, ".polished"),
        ({"polish": {"after": errors(torque_rms_N_m=None)}}, ".polish.after.torque_rms_N_m"),
        ({"judged": {"before": {"trials": []}}}, ".judged.before.trials"),
        ({"notes": ["a sentence"]}, ".notes[]"),
    ],
)
def test_what_is_otherwise_is_not(change: dict[str, object], where: str) -> None:
    assert faults(document() | change, {"properties": DIAGNOSIS_FIELDS}, "") == [where]


def test_one_role_has_sets_and_trials_each() -> None:
    judged = DIAGNOSIS_FIELDS["judged"]["properties"]["before"]["properties"]
    assert judged["sets"]["description"] == "the same, one set each"
    assert judged["trials"]["description"] == "the same, one trial each"
