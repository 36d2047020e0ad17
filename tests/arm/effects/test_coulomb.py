"""Friction that depends on the direction alone."""

import numpy as np
import pytest

from arm.simulation import simulate


def test_it_is_the_same_at_every_speed_of_a_direction(resists):
    found = resists("coulomb", {"coulomb_N_m": 0.5}, dq=[-3.0, -0.1, 0.0, 0.1, 3.0])
    np.testing.assert_allclose(found, [-0.5, -0.5, 0.0, 0.5, 0.5])


def test_a_resting_joint_lets_go_beyond_both_frictions(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "coulomb", coulomb_N_m=0.5)
    assert let_go(arm) == pytest.approx(0.9, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-0.9, abs=1.1e-3)


def test_it_is_more_of_the_files_own_friction(wheel, having, rubbing, held):
    ref = held(0.3, 1500)
    runs = [
        simulate(arm, ref, 1e-3, np.zeros(1)).q
        for arm in (having(rubbing(wheel, 0.1, 0.4), "coulomb", coulomb_N_m=0.25), rubbing(wheel, 0.1, 0.65))
    ]
    assert np.ptp(runs[0]) > 0.1
    np.testing.assert_allclose(runs[0], runs[1], rtol=0, atol=1e-11)


def test_it_may_be_negative(ranges):
    ranges("coulomb", "coulomb_N_m", -1e3, 1e3)
