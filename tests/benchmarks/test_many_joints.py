"""Arms of many joints are the same in pinocchio, whatever hangs on what."""

import numpy as np
import pinocchio as pin
import pytest

from arm.newton_euler import inverse_dynamics
from benchmarks.many_joints import TREES, arm_of, times
from benchmarks.pinocchio_model import pinocchio_model


@pytest.mark.parametrize("name", TREES)
def test_each_is_timed_beside_the_same_arm(name: str) -> None:
    arm = arm_of(TREES[name])
    found = times(arm, 20)
    assert set(found) == {"pinocchio", "rows", "kept"} and min(found.values()) > 0.0
    model, q = pinocchio_model(arm), np.linspace(-1.0, 1.0, arm.n_joint)
    gravity = pin.computeGeneralizedGravity(model, model.createData(), q)
    np.testing.assert_allclose(inverse_dynamics(arm, q[None], 0.0 * q[None], 0.0 * q[None])[0], gravity, atol=1e-9)
