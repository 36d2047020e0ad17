"""The page of ratios up to scale."""

from fitter.controller.equilibrium_ratios import EquilibriumFit, EquilibriumRatio
from fitter.report.equilibrium_page import write_equilibrium_page

TOLD = EquilibriumRatio("(kp1)/I1", "N m/rad / (kg m^2)", 401.25, (390.5, 412.5))
UNTOLD = EquilibriumRatio("(m1*sx1)/I1", "kg m / (kg m^2)", 77.25, None)


def test_a_ratio_that_is_not_told_has_no_number(tmp_path):
    path = tmp_path / "page.html"
    write_equilibrium_page(path, "forearm", EquilibriumFit((TOLD, UNTOLD), 0.8, 6.0), [])
    page = path.read_text()
    assert all(number in page for number in ("390.5", "412.5")) and "77.25" not in page
    assert "slower than 0.8 Hz" in page and "1 of 2 ratios are known" in page


def test_where_no_trajectory_will_do_the_page_says_so(tmp_path):
    path = tmp_path / "page.html"
    write_equilibrium_page(path, "forearm", EquilibriumFit((), None, 6.0), [])
    assert "no ratio is known" in path.read_text()
