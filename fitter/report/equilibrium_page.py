"""The page of `fitter dynamics --unknown-gains --report` where no law, gain or target is known."""

from collections.abc import Sequence
from pathlib import Path

from fitter.controller.equilibrium_ratios import EquilibriumFit
from fitter.report.page import Page
from fitter.report.provenance import provenance


def write_equilibrium_page(path: Path, name: str, fit: EquilibriumFit, files: Sequence[Path]) -> None:
    """Write the page.

    Parameters
    ----------
    path : Path
    name : str
        Of the arm.
    fit : EquilibriumFit
    files : sequence of Path
        What was read.

    Raises
    ------
    DeviceError
        If it cannot be written.
    """
    page = Page(name, "Up to scale: ratios under law (5) with a free equilibrium trajectory, no kilograms.")
    page.section("What the ratios are worth")
    page.points(fit.sentences())
    if fit.ratios:
        page.section("Ratios", "With 95 % intervals. A dash: this motion does not tell the ratio.")
        rows = [
            [one.name, *((None,) * 3 if one.ci95 is None else (one.value, *one.ci95)), one.unit]
            for one in fit.ratios
        ]
        page.table(["ratio", "value", "from", "to", "unit"], rows)
    page.section("Where this comes from")
    page.table(("", ""), provenance(files).rows(), words=True)
    page.write(path)
