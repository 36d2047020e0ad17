"""Spring and damper, against what they must obey."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from playback.touch.coupling import spring_and_damper, spring_energy

UNHURRIED = settings(deadline=None)  # the first call may compile

VECTOR = st.tuples(*[st.floats(-2.0, 2.0)] * 3)


@UNHURRIED
@given(st.floats(0.0, 5000.0), st.floats(0.1, 50.0), st.floats(1e-3, 1.0))
def test_the_pull_is_the_slope_of_the_energy(stiffness: float, limit: float, stretch: float) -> None:
    force = spring_and_damper(stiffness, 0.0, limit, (stretch, 0.0, 0.0), (0.0, 0.0, 0.0))
    h = 1e-6
    ahead, behind = (spring_energy(stiffness, limit, stretch + side * h) for side in (1.0, -1.0))
    assert force[0] == pytest.approx((ahead - behind) / (2.0 * h), rel=1e-3, abs=1e-6)
    assert force[0] == pytest.approx(min(stiffness * stretch, limit))


@UNHURRIED
@given(st.floats(0.0, 5000.0), st.floats(0.0, 100.0), st.floats(0.1, 50.0), VECTOR, VECTOR)
def test_the_limit_is_kept_and_the_damper_never_pushes(stiffness, damping, limit, e, de) -> None:
    both = np.array(spring_and_damper(stiffness, damping, limit, e, de))
    spring = np.array(spring_and_damper(stiffness, 0.0, limit, e, (0.0, 0.0, 0.0)))
    assert np.linalg.norm(both) <= limit * (1.0 + 1e-9)
    taken = float((both - spring) @ de)  # the power that the damper takes
    assert -1e-9 * (1.0 + limit) <= taken <= damping * float(np.dot(de, de)) + 1e-9 * (1.0 + limit)
