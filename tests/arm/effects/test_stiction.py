"""A joint that sticks at rest."""

import pytest

from arm.effects.effect_table import changed
from arm.model import Friction


def test_its_joint_alone_gets_the_static_friction(arm, having):
    stuck = changed(having(arm, "stiction", joint=2, static_N_m=1.3))
    assert [joint.friction for joint in stuck.joints] == [
        Friction(0.3, 0.2, 0.0),
        Friction(0.3, 0.2, 1.3),
        Friction(0.3, 0.2, 0.0),
    ]


def test_a_resting_joint_lets_go_at_its_level(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 0.0), "stiction", static_N_m=1.3)
    assert let_go(arm) == pytest.approx(1.3, abs=1.1e-3)
    assert let_go(arm, rate=-1.0) == pytest.approx(-1.3, abs=1.1e-3)


def test_static_friction_holds_alone_where_it_is_more_than_sliding(wheel, having, rubbing, let_go):
    arm = having(rubbing(wheel, 0.1, 0.4, 1.3), "stribeck", amplitude_N_m=0.5, velocity_rad_s=0.1)
    assert let_go(arm) == pytest.approx(1.3, abs=1.1e-3)
    more = having(arm, "stribeck", amplitude_N_m=0.6, velocity_rad_s=0.1)
    assert let_go(more) == pytest.approx(1.5, abs=1.1e-3)


def test_it_is_not_negative(ranges):
    ranges("stiction", "static_N_m", 0.0, 1e3)
