"""The pages of the cases: what `fitter diagnose` answered, and nothing else."""

import json
from pathlib import Path

import pytest

from examples.cases.bam_xl330 import CASE as XL330
from examples.cases.case_page import Case, page, run_case
from examples.cases.dfki_double_pendulum import CASE as DFKI
from examples.cases.multiarm_pendulum import CASE as FREE
from examples.cases.multiarm_pendulum import main
from fitter.__main__ import COMMANDS
from limbcal.arguments import parser_of

ROOT = Path(__file__).parents[2]
ANSWER = {
    "verdict": "ambiguous",
    "complete": False,
    "left": {"torque_rms_N_m": [0.05, 0.07], "share": 0.56, "times_noise": 53.0},
    "causes": [
        {
            "effect": "rotor_inertia",
            "joints": [2],
            "parameters": {"inertia_kg_m2": {"value": 0.00321, "std": 0.0005, "unit": "kg m^2"}},
            "support": 1.0,
            "takes_away": {"learn": 0.18, "evaluate": 0.41},
        },
        {
            "effect": "stiction",
            "joints": [1],
            "parameters": {"static_N_m": {"value": 0.3, "std": None, "unit": "N m"}},
            "support": 0.6,
            "takes_away": {},
        },
    ],
    "before": {"torque_rms_N_m": [0.138, 0.0624], "angle_error_deg": {"mean": None, "max": None}},
    "after": {"torque_rms_N_m": [0.0496, 0.0694], "angle_error_deg": {"mean": 2.97, "max": 65.9}},
    "residual": {"depends_on": ["q2"], "joint": 2, "explained": 0.3},
    "next_experiment": "Do it again.",
    "notes": [{"kind": "doubt", "text": "the torque is mostly noise"}, {"kind": "resampled", "text": "to 2 ms"}],
}


def text(case: Case, answer: object) -> str:
    return "\n".join(page(case, json.loads(json.dumps(answer))))


def test_a_page_has_causes_sizes_equals_errors_and_what_is_left():
    said = text(DFKI, ANSWER)
    assert "`inertia_kg_m2` 0.00321 ± 0.00098 kg m^2" in said
    assert "takes away 18 % on the learning trials and 41 % on the evaluating trials" in said
    assert "`static_N_m` 0.3000 N m" in said and "60 % of the support" in said
    assert "| simulated angle, mean [deg] | runs away | 2.97 |" in said
    assert "56 % of what the base model leaves" in said and "depends on q2 at joint 2" in said
    assert "the torque is mostly noise" in said and "to 2 ms" not in said


def test_torques_are_in_the_units_of_the_case():
    said = text(XL330, {**ANSWER, "complete": True})
    assert "0.3000 unit" in said and "N m" not in said
    assert "The model is complete" in said


@pytest.mark.parametrize("case", [DFKI, XL330, FREE])
def test_a_case_is_a_command_that_exists(case: Case):
    words = [*case.words("data", str(ROOT / "examples")), "--out", "out"]
    parsed = parser_of("fitter", "", "fitter.commands", COMMANDS).parse_args(["diagnose", *words])
    assert parsed.arm and Path(str(parsed.arm)).exists()
    assert not set(parsed.learn) & set(parsed.evaluate) or parsed.evaluate_columns


def test_a_page_is_made_of_an_answer_that_is_there(tmp_path):
    (tmp_path / "diagnosis.json").write_text(json.dumps(ANSWER), encoding="utf-8")
    (tmp_path / f"diagnosis-{DFKI.picture}.png").write_bytes(b"\x89PNG")
    assert run_case(DFKI, ["--diagnosis", str(tmp_path), "--out", str(tmp_path)]) == 0
    assert "rotor_inertia" in (tmp_path / "dfki-double-pendulum.md").read_text(encoding="utf-8")
    assert (tmp_path / "dfki-double-pendulum.png").read_bytes() == b"\x89PNG"


def test_missing_recordings_are_one_sentence(tmp_path, capfd):
    assert main(["--data", str(tmp_path), "--out", str(tmp_path)]) == 2
    said = capfd.readouterr().err
    assert "DoublePendulumData" in said and "Traceback" not in said
