"""Table 3."""

import numpy as np
import pytest

from fitter.report.published import PARAMETERS, TABLE3, TRUE
from reproduction.experiment import Experiment, Settings
from reproduction.table3 import run


@pytest.fixture(scope="module")
def row() -> dict:
    found: Experiment = run(Settings(quick=True))
    (only,) = found.document["rows"]
    return only


def test_the_papers_row_stands_beside_ours(row):
    assert row["noise_percent"] == 10
    assert tuple(row["paper"].values()) == TABLE3[10]


def test_differences_of_noisy_angles_leave_the_laws_own_damping_in_the_friction(row):
    parameters = row["methods"]["A: plain, derivatives by differences"]["parameters"]
    assert abs(parameters["I1+m2*L1^2"]["value"]) < 0.1
    np.testing.assert_allclose([parameters[name]["value"] for name in ("D1", "D2")], -9.5, rtol=0.05)


def test_the_simulated_motion_is_as_sure_as_can_be_and_right_within_it(row):
    parameters = row["methods"]["A: ours, simulated motion"]["parameters"]
    least = row["least_std"]
    for name, true in zip(PARAMETERS, TRUE, strict=True):
        assert abs(parameters[name]["value"] - true) < 4.0 * least[name]
        assert 0.5 < parameters[name]["std"] / least[name] < 2.0
