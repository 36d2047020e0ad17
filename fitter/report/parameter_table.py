"""Fitted parameters at the terminal, other arms beside them."""

from collections.abc import Mapping

from rich.table import Table

from fitter.search.fitted_parameter import FittedParameter


def parameter_table(
    title: str, parameters: Mapping[str, FittedParameter], beside: Mapping[str, Mapping[str, float]]
) -> Table:
    """Return a table of parameters; ``beside`` holds the values of other arms by the arm's name.

    A parameter that the data said nothing of is shown without a standard error, in brackets. With many arms beside
    it the 95 % interval, twice the standard error to either side, would not fit a terminal and is left out.
    """
    table = Table(title=title, title_justify="left", caption="(in brackets: not revealed by this data)")
    interval = not beside
    for column in ("parameter", "value", "std", *(("95 % interval",) if interval else ())):
        table.add_column(column, justify="left" if column == "parameter" else "right", no_wrap=True)
    for name in beside:
        table.add_column(name, justify="right", overflow="fold", min_width=9)
    table.add_column("unit", no_wrap=True)
    for name, p in parameters.items():
        known = [f"{values[name]:.6f}" if name in values else "–" for values in beside.values()]
        value, std, ci95 = f"({p.value:.6f})", "–", "–"
        if p.identifiable:
            value, std = f"{p.value:.6f}", f"{p.std:.2g}"
            ci95 = "–" if p.ci95 is None else f"{p.ci95[0]:.5g} … {p.ci95[1]:.5g}"
        table.add_row(name, value, std, *((ci95,) if interval else ()), *known, p.unit)
    return table
