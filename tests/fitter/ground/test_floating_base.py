"""The six base equations are the base rows of eq. (4), and arms without a floating base are told so."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Link
from arm.moving_base import standing_base
from arm.newton_euler import inverse_dynamics
from benchmarks.simulated_people.ground import BASE, PERSON
from fitter.ground.floating_base import along_joints, base_regressor, floating_base
from fitter.ground.link_motion import link_motions
from limbcal.errors import ConfigError


def test_base_rows_are_those_of_the_recursion():
    rng = np.random.default_rng(0)
    q, dq, ddq = (rng.normal(0.0, 0.6, (7, PERSON.n_joint)) for _ in range(3))
    motions = link_motions(PERSON, q, dq, ddq, standing_base(len(q)))
    wrench = base_regressor([motions[i] for i in BASE.bodies]) @ BASE.links.ravel()
    rows = along_joints(wrench, [motions[i] for i in BASE.joints], [True] * 3 + [False] * 3)
    expected = inverse_dynamics(PERSON, q, dq, ddq)[:, :6]
    np.testing.assert_allclose(rows, expected, atol=1e-9 * np.abs(expected).max())


def test_an_arm_without_a_floating_base_or_masses_is_refused():
    with pytest.raises(ConfigError, match="no floating base"):
        floating_base(load_arm("dd-arm"))
    empty = replace(PERSON, joints=tuple(replace(joint, link=Link()) for joint in PERSON.joints))
    with pytest.raises(ConfigError, match="no link has a mass"):
        floating_base(empty)
