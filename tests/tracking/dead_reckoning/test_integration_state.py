"""Where dead reckoning begins."""

import numpy as np
import pytest

from arm.kinematics import sensor_positions
from arm.model import Arm
from tracking.dead_reckoning.integration_state import reckoning_of


@pytest.mark.parametrize("which", ["dd_arm", "sliding", "spatial"])
def test_it_begins_at_rest_where_the_arm_is(which: str, request: pytest.FixtureRequest) -> None:
    arm: Arm = request.getfixturevalue(which)
    q = 0.3 - 0.2 * np.arange(arm.n_joint)
    begun, places = reckoning_of(arm, q), sensor_positions(arm, q[None])[0]
    n_sensor = len(arm.sensors)
    np.testing.assert_allclose(begun.start, places)
    for (one, two), line in zip(begun.pair, begun.baseline, strict=True):
        np.testing.assert_allclose(line, places[two] - places[one])
    for name, shape in {
        **{"velocity": (n_sensor, 3), "moved": (n_sensor, 3), "recent": (4, 3 * n_sensor)},
        **{"offset": (3 * n_sensor,), "gravity": (3 * n_sensor,)},
    }.items():
        np.testing.assert_array_equal(getattr(begun, name), np.zeros(shape), err_msg=name)
    np.testing.assert_array_equal(begun.q, q)
    begun.q[:] += 1.0  # its own, and not the caller's or that of the sample before
    np.testing.assert_array_equal(begun.q_before, q)
    assert q[0] == 0.3
