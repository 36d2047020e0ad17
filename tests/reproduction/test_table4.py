"""Table 4, small."""

import pytest

from fitter.report.published import PARAMETERS, TABLE4, TRUE
from reproduction.experiment import Settings
from reproduction.table4 import run


@pytest.fixture(scope="module")
def experiment():
    return run(Settings(quick=True))


def test_driven_with_other_gains_the_parameters_come_out_right(experiment):
    for row in experiment.document["rows"]:
        assert [row["A"][name]["value"] for name in PARAMETERS] == pytest.approx(TRUE, rel=1e-3, abs=1e-5)
        assert row["angle_error_deg"]["A: driven with these"]["max"] < 1e-2


def test_other_gains_assumed_every_parameter_is_wrong_by_the_factor_and_nothing_moves_otherwise(experiment):
    for row in experiment.document["rows"]:
        factor = row["kp"] / 9.5
        wrong = [factor * value for value in TRUE]
        assert [row["B"][name]["value"] for name in PARAMETERS] == pytest.approx(wrong, rel=1e-5, abs=1e-8)
        errors = row["angle_error_deg"]
        assert errors["B: driven with 9.5 / -9.5, simulated under these"]["max"] < 1e-3
        assert errors["B: driven with 9.5 / -9.5, simulated under 9.5 / -9.5"]["max"] > 1.0


def test_gains_that_nobody_knows_are_found(experiment):
    for row in experiment.document["rows"]:
        for name in ("kp1", "kp2"):
            gain = row["C"]["gains"][name]
            assert abs(gain["value"] - row["kp"]) < 5.0 * gain["std"]
            assert gain["std"] < 0.1 * row["kp"]
        assert row["C"]["fixed_by"].startswith("given, I2 = 0.471209")


def test_the_paper_s_rows_stand_beside_ours(experiment):
    for row in experiment.document["rows"]:
        assert tuple(row["paper"].values()) == TABLE4[row["kp"], row["kv"]]
    cases = [row[3] for row in experiment.grids[0].rows]
    assert cases[1:5] == ["paper", "A", "B", "C"]
    assert any("No motion shows the factor" in said for said in experiment.findings)
