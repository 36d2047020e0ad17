"""Fitted parameters at the terminal, other arms next to them."""

from collections.abc import Mapping

from rich import box
from rich.table import Table
from rich.text import Text

from fitter.report.parameter_listing import HEADING, heading, parameter_rows
from fitter.search.fitted_parameter import FittedParameter

#: A number of six digits with its sign and point still stands in one line.
_NARROWEST = 9


def parameter_table(
    title: str, parameters: Mapping[str, FittedParameter], others: Mapping[str, Mapping[str, float]]
) -> Table:
    """Return a table of parameters; ``others`` holds the values of other arms by the arms' names."""
    table = Table(title=Text(title), title_justify="left", box=box.SIMPLE_HEAD)
    for column in heading(others):
        table.add_column(
            Text(column),
            justify="left" if column in ("parameter", "unit") else "right",
            no_wrap=column in HEADING[1:],
            overflow="fold",
            min_width=_NARROWEST if column in others else None,
        )
    for row in parameter_rows(parameters, others):
        table.add_row(*map(Text, row.cells))
    return table
