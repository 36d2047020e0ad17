"""Table 1."""

import numpy as np
import pytest

from reproduction.experiment import Experiment, Settings
from reproduction.table1 import run


@pytest.fixture(scope="module")
def found() -> Experiment:
    return run(Settings(quick=True))


@pytest.mark.parametrize("kind", ["drawn", "motion"])
def test_without_noise_both_fits_find_the_lengths(found, kind):
    errors = found.document[kind][0]["worst_length_error_mm"]
    assert errors["plain"] < 1e-6
    assert errors["best"] < 1e-6


@pytest.mark.parametrize("kind", ["drawn", "motion"])
def test_noise_shrinks_a_plain_fit_and_not_ours(found, kind):
    row = found.document[kind][-1]
    assert (row["tip_mm"], row["angle_deg"]) == (30.0, 15.0)
    # more than for angles over full turns, where the law is exp(-s^2/2)
    assert row["plain"]["a1"]["value"] < 0.25 * np.exp(-0.5 * np.deg2rad(15.0) ** 2)
    assert row["plain"]["a2"]["value"] < 0.30 * np.exp(-(np.deg2rad(15.0) ** 2))
    for name, true in (("a1", 0.25), ("a2", 0.30)):
        best = row["best"][name]
        assert abs(best["value"] - true) < 4.0 * best["std"]
    np.testing.assert_allclose(row["angle_noise_deg"], 15.0, rtol=0.05)


def test_the_worst_row_is_repeated_with_other_seeds(found):
    errors = found.document["worst_row_over_seeds_mm"]
    assert len(set(errors)) == len(errors) == 2
    assert [len(grid.rows) for grid in found.grids if grid.title.startswith("The worst row")] == [2]


def test_the_papers_rows_stand_beside_ours(found):
    assert found.document["drawn"][-1]["paper"] == {
        "a1": 0.24974,
        "a2": 0.27923,
        "alpha2": 0.01176,
        "beta2": -0.03088,
    }
    assert "0.27923" in found.grids[0].rows[-1]
