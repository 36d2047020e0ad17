"""The quick rows against the regressor."""

import numpy as np
import pytest

from arm.chain import chain_of
from arm.model import Arm, Joint
from arm.regressor import regressor
from fitter.torque_rows import torque_rows


def random_arm(rng: np.random.Generator, n_joint: int) -> Arm:
    kinds = rng.choice(["revolute", "prismatic"], n_joint)
    joints = (Joint(kind, *rng.normal(size=5)) for kind in kinds)
    return Arm("random", tuple(joints), tuple(rng.normal(size=3)))


@pytest.mark.parametrize("n_joint", [1, 2, 3, 7])
def test_rows_are_those_of_the_regressor(n_joint):
    rng = np.random.default_rng(n_joint)
    for _ in range(5):
        arm = random_arm(rng, n_joint)
        q, dq, ddq = rng.normal(size=(3, 20, n_joint))
        Y = np.zeros((20, n_joint, 12 * n_joint))
        torque_rows(chain_of(arm), q, dq, ddq, Y)
        assert np.allclose(Y, regressor(arm, q, dq, ddq), rtol=1e-12, atol=1e-11)
