"""The terminal's table of parameters has the rows of the listing, other arms between value and unit."""

from fitter.report.parameter_listing import heading, parameter_rows
from fitter.report.parameter_table import parameter_table
from fitter.search.fitted_parameter import FittedParameter

PARAMETERS = {
    "a1": FittedParameter(0.3012, 0.0004, "m", True),
    "d1": FittedParameter(0.0, float("nan"), "m", False),
}
OTHERS = {"true": {"a1": 0.3}}


def test_its_cells_are_those_of_the_listing():
    table = parameter_table("geometry", PARAMETERS, OTHERS)
    assert [str(column.header) for column in table.columns] == list(heading(OTHERS))
    cells = zip(*([str(cell) for cell in column.cells] for column in table.columns), strict=True)
    assert list(cells) == [tuple(row.cells) for row in parameter_rows(PARAMETERS, OTHERS)]
    assert str(table.title) == "geometry"
