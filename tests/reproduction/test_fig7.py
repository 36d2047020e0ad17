"""Fig. 7."""

from fitter.report.figures import png
from reproduction.experiment import Settings
from reproduction.fig7 import run


def test_the_smoother_is_nearer_to_the_truth_than_double_integration():
    found = run(Settings(quick=True))
    errors = found.document["angle_error_deg"]
    ours, plain = errors["ours: smoother"], errors["plain: double integration"]
    assert ours["learn"]["mean"] < 0.5 * plain["learn"]["mean"]
    assert ours["evaluate"]["max"] < 1.0
    assert found.document["motions"] == 4
    assert png(found.pictures[0].figure).startswith(b"\x89PNG")
