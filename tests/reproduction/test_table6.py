"""Table 6."""

import pytest

from fitter.report.published import PARAMETERS, TABLE6, TRUE
from reproduction.experiment import Settings
from reproduction.table6 import run


@pytest.fixture(scope="module")
def found():
    return run(Settings(quick=True))


def test_with_few_data_the_papers_row_stands_beside_ours(found):
    (row,) = found.document["rows"]
    assert row["data"] == 1000
    assert tuple(row["paper"].values()) == TABLE6[1000]
    for method in ("ours, simulated motion", "plain, derivatives exact"):
        parameters = row["methods"][method]["parameters"]
        for name, true in zip(PARAMETERS[:4], TRUE[:4], strict=True):
            assert abs(parameters[name]["value"] - true) < 5.0 * parameters[name]["std"]


def test_the_same_seed_gives_the_same_figures(found):
    assert run(Settings(quick=True)).document == found.document
