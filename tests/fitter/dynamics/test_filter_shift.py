"""How far a filter shifts eq. (9): part of its standard errors."""

import numpy as np
import pytest

from benchmarks.coverage import learn
from benchmarks.coverage_case import draw_case


@pytest.mark.parametrize("repeat", [1])
def test_intervals_hold_what_a_low_corner_shifts(repeat):
    """Without the shift's square they held 80 % of this arm's parameters, with errors whose scatter was right."""
    found = [one for one in learn(draw_case(83014, 6, "q", repeat), None) if one.kind != "static"]
    assert {one.objective for one in found} == {"torque"}
    assert np.mean([one.inside for one in found]) >= 0.9
