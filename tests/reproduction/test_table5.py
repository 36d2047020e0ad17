"""Table 5, small."""

import pytest

from fitter.report.published import PARAMETERS, TRUE
from reproduction.experiment import Settings
from reproduction.table5 import run


@pytest.fixture(scope="module")
def experiment():
    return run(Settings(quick=True))


def test_driven_by_law_7_the_parameters_come_out_right(experiment):
    (row,) = experiment.document["rows"]
    assert row["law"] == "p"
    assert [row["A"][name]["value"] for name in PARAMETERS] == pytest.approx(TRUE, rel=1e-3, abs=1e-5)


def test_law_7_assumed_of_an_arm_under_law_5_makes_friction_of_kv(experiment):
    (row,) = experiment.document["rows"]
    factor = row["kp"] / 9.5
    for name in ("D1", "D2"):
        assert row["B"][name]["value"] == pytest.approx(factor * 9.5, rel=1e-3)
    assert row["B"]["I2"]["value"] == pytest.approx(factor * TRUE[3], rel=1e-5)
    errors = row["angle_error_deg"]
    assert errors["B: driven with 9.5 / -9.5, simulated under these"]["max"] < 1e-3
    assert errors["B: driven with 9.5 / -9.5, simulated under 9.5 / -9.5"]["max"] > 1.0


def test_the_gain_of_law_7_is_found(experiment):
    (row,) = experiment.document["rows"]
    for name in ("kp1", "kp2"):
        gain = row["C"]["gains"][name]
        assert abs(gain["value"] - row["kp"]) < 5.0 * gain["std"]


def test_a_missing_term_is_named(experiment):
    (form,) = experiment.document["forms"]
    assert (form["driven_by"], form["assumed"]) == ("pda", "pd")
    assert form["missing"] == ["ka ddq"]
    assert not form["fits"]
