"""The page of a calibration, and what stands on it in red."""

import pytest

from arm.arm_file import load_arm
from fitter.report.calibration_page import (
    CalibrationPage,
    Section,
    error_rows,
    trials_are_missing,
    trials_sentence,
)
from fitter.report.provenance import Provenance
from fitter.search.fitted_parameter import FittedParameter
from limbcal.note import Note


def page(tmp_path, **fields):
    """Write a page with some fields of its own and return its text."""
    given = {
        "arm": load_arm("spatial-arm"),
        "lead": "2 motions learnt from.",
        "sections": [Section("Dynamics", {"I3zz": FittedParameter(0.0123, 0.0005, "kg m^2", True)})],
        "errors": [("simulated angle, mean [deg]", {"learn": 0.02})],
        "assumptions": ["Links are rigid."],
        "notes": [
            *[Note("unit", "is in degrees", source=source) for source in ("<a.csv>", "<a.csv>", "b.csv")],
            Note("filtered", "low-passed"),
        ],
        "provenance": Provenance("fitter dynamics 'a b.csv'", "2026-01-01 12:00:00+00:00", "0.1.0", ("a b.csv",)),
    }
    CalibrationPage(**(given | fields)).write(tmp_path / "report.html")
    return (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_page_says_what_was_found_and_what_it_rests_on(tmp_path):
    text = page(tmp_path)
    for words in (
        "Calibration of spatial-arm",
        "<td>I3zz</td><td>0.01230</td><td>0.00098</td><td>kg m^2</td>",
        "Ixx_j, Iyy_j, Izz_j",
        "<li>Links are rigid.</li>",
        "<td>command</td><td>fitter dynamics &#x27;a b.csv&#x27;</td>",
        "<td>files</td><td>a b.csv</td>",
        "<td>simulated angle, mean [deg]</td><td>0.02000</td>",
    ):
        assert words in text, words
    assert text.count("<li>&lt;a.csv&gt;, b.csv: is in degrees</li>") == 1
    assert "<summary>What was done to the data</summary><ul><li>low-passed</li></ul>" in text
    assert "paper" not in text and '<p class="alarm">' not in text


@pytest.mark.parametrize(
    ("trials", "missing"),
    [
        ({"learn": 5, "evaluate": 17, "expected": 22, "lost_s": 0.0}, False),
        ({"learn": 5, "evaluate": 17, "expected": None, "lost_s": None}, False),
        ({"learn": 1, "evaluate": 0, "expected": 22, "lost_s": 0.0}, True),
        ({"learn": 5, "evaluate": 17, "expected": 22, "lost_s": 2.3}, True),
    ],
)
def test_motions_that_are_missing_are_red(tmp_path, trials, missing):
    assert trials_are_missing(trials) == missing
    text = page(tmp_path, trials=trials)
    assert ('<p class="alarm">' in text) == missing
    assert trials_sentence(trials) in text
    assert ("22" in trials_sentence(trials)) == (trials["expected"] is not None)
    assert ("2.3 s of frames lost" in trials_sentence(trials)) == (trials["lost_s"] == 2.3)


def test_an_answer_that_is_not_to_be_used_says_so_in_red(tmp_path):
    text = page(tmp_path, alarms=["no possible arm fits"])
    assert '<p class="alarm">no possible arm fits</p>' in text


def test_errors_are_rows_by_role():
    dynamics = {
        "angle_error_deg": {"learn": {"mean": 0.1, "max": 0.5}, "evaluate": None},
        "torque_rms_N_m": {"learn": [1.0, 2.0], "evaluate": None},
        "explained": {"learn": [0.9], "evaluate": None},
    }
    kinematics = {"tip_error_mm": {"learn": {"mean": 3.0, "max": 4.0}, "evaluate": {"mean": 5.0, "max": 6.0}}}
    assert error_rows(dynamics, kinematics) == [
        ("simulated angle, mean [deg]", {"learn": 0.1}),
        ("simulated angle, max [deg]", {"learn": 0.5}),
        ("tip's displacement, mean [mm]", {"learn": 3.0, "evaluate": 5.0}),
        ("tip's displacement, max [mm]", {"learn": 4.0, "evaluate": 6.0}),
        ("joint 1, residual torque, rms [N m or N]", {"learn": 1.0}),
        ("joint 2, residual torque, rms [N m or N]", {"learn": 2.0}),
        ("joint 1, torque explained", {"learn": 0.9}),
    ]
    assert error_rows(None, None) == []
