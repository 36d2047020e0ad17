"""Fitted parameters as a person reads them."""

import numpy as np
import pytest
from rich.console import Console

from fitter.report.parameter_listing import heading, parameter_rows
from fitter.report.parameter_table import parameter_table
from fitter.search.fitted_parameter import FittedParameter
from limbcal.digits import NORMAL_95

PARAMETERS = {
    "m2*sx2": FittedParameter(1.71863, 0.0006, "kg m", True),
    "D1": FittedParameter(0.0, np.nan, "N m s/rad", False),
    "fc1": FittedParameter(0.010918, np.nan, "N m", True),
}


def test_a_row_holds_value_interval_unit_and_what_others_have():
    rows = parameter_rows(PARAMETERS, {"true": {"m2*sx2": 1.718632, "D1": -0.002409}, "paper": {"fc1": 0.0109}})
    assert [row.cells for row in rows] == [
        ("m2*sx2", "1.7186", "0.0012", "1.7186", "–", "kg m"),
        ("D1", "not identifiable", "–", "-0.002409", "–", "N m s/rad"),
        ("fc1", "0.01092", "–", "–", "0.01090", "N m"),
    ]
    assert heading({"true": {}, "paper": {}}) == ("parameter", "value", "± (95 %)", "true", "paper", "unit")


def test_the_half_width_is_that_of_the_interval():
    assert PARAMETERS["m2*sx2"].half_width == pytest.approx(NORMAL_95 * 0.0006)
    assert np.isnan(PARAMETERS["D1"].half_width) and np.isnan(PARAMETERS["fc1"].half_width)


def test_the_table_at_the_terminal_has_the_same_cells_in_80_columns():
    console = Console(width=80, record=True)
    others = {"dd-arm": {"m2*sx2": 1.718632}, "[true]": {"fc1": 0.0109}}
    console.print(parameter_table("arm [m]", PARAMETERS, others))
    lines = console.export_text().splitlines()
    assert "arm [m]" in lines[0] and "[true]" in lines[2]
    for row in parameter_rows(PARAMETERS, others):
        assert any(all(cell in line for cell in row.cells) for line in lines), row
    assert max(map(len, lines)) <= 80
