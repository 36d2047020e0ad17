"""What no arm can have is named; what its errors or its law allow is not."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm, preset_names
from arm.model import Control, Estimate, Friction, Link
from arm.possible import impossibilities, why_it_runs_away
from arm.simulation import simulate

ARM = load_arm("dd-arm")


def fields(arm):
    return [field for field, _ in impossibilities(arm)]


def with_link(**changed):
    joint = replace(ARM.joints[0], link=replace(ARM.joints[0].link, **changed))
    return replace(ARM, joints=(joint, ARM.joints[1]))


def with_friction(**changed):
    return replace(ARM, joints=(replace(ARM.joints[0], friction=Friction(**changed)), ARM.joints[1]))


@pytest.mark.parametrize("name", preset_names())
def test_built_in_arms_can_be(name):
    assert fields(load_arm(name)) == []


@pytest.mark.parametrize(
    ("link", "said"),
    [
        ({"mass_kg": -1.0}, "mass_kg is -1"),
        (
            {"mass_kg": 1.0, "com_m": (0.0, 0.0, 0.0), "inertia_kg_m2": (0.01, 0.01, 9.0, 0.0, 0.0, 0.0)},
            "two together",
        ),
        (
            {"mass_kg": 1.0, "com_m": (0.2, 0.0, 0.0), "inertia_kg_m2": (0.01, 0.01, 0.02, 0.0, 0.0, 0.0)},
            "below zero",
        ),
        (
            {"mass_kg": 1.0, "com_m": (0.2, 0.0, 0.0), "inertia_kg_m2": (0.0, 0.0, 0.01, 0.0, 0.0, 0.0)},
            "below zero",
        ),
    ],
)
def test_a_link_that_is_no_body_is_named(link, said):
    ((field, text),) = impossibilities(with_link(**link))
    assert field.startswith("joint[0].link.") and said in text


def test_points_rods_and_plates_are_bodies():
    rng = np.random.default_rng(0)
    for n in (1, 2, 3, 50):
        places, masses = rng.normal(size=(n, 3)), rng.uniform(0.1, 1.0, n)
        second = np.einsum("n,ni,nj->ij", masses, places, places)
        about = np.trace(second) * np.eye(3) - second
        com = masses @ places / masses.sum()
        six = tuple(about[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        assert fields(with_link(mass_kg=masses.sum(), com_m=tuple(com), inertia_kg_m2=six)) == []


def test_a_moment_that_is_not_given_is_no_doubt():
    assert (
        fields(with_link(mass_kg=2.0, com_m=(0.1, 0.0, 0.0), inertia_kg_m2=(0.0, 0.0, 0.05, 0.0, 0.0, 0.0))) == []
    )
    assert list(impossibilities(replace(ARM, joints=(replace(ARM.joints[0], link=Link()), ARM.joints[1])))) == []


def test_numbers_beyond_all_units_are_no_error():
    assert fields(with_link(mass_kg=1e300, com_m=(1e300, 0.0, 0.0))) == []


def test_friction_that_drives_a_moving_joint_is_named():
    assert fields(with_friction(viscous_N_m_s=-20.0)) == ["joint[0].friction.viscous_N_m_s"]
    assert fields(with_friction(coulomb_N_m=-1.0)) == ["joint[0].friction.coulomb_N_m"]
    assert fields(with_friction(static_N_m=-0.1)) == ["joint[0].friction.static_N_m"]
    assert fields(with_friction(viscous_N_m_s=-0.1)) == []  # the law damps more


def test_friction_below_zero_within_its_error_is_no_doubt():
    free = replace(with_friction(viscous_N_m_s=-0.1), control=Control())
    first = replace(free, joints=(free.joints[0], replace(free.joints[1], friction=Friction())))
    assert fields(first) == ["joint[0].friction.viscous_N_m_s"]
    assert fields(replace(first, base_parameters={"D1": Estimate(-0.1, 0.06)})) == []


def test_gains_that_drive_are_why_a_simulation_runs_away():
    driven = replace(ARM, control=Control("pd", kp=(9.5, 9.5), kv=(900.0, -9.5)))
    with np.errstate(all="ignore"):
        assert not np.isfinite(simulate(driven, np.ones((4000, 2)), 0.01, np.zeros(2)).q).all()
    assert fields(driven) == ["control.kv[0]"] and "control.kv[0] is 900" in why_it_runs_away(driven)
    assert "control.kp[0]" in fields(replace(ARM, control=Control("p", kp=(-1.0, 1.0))))
    assert "expected masses" in why_it_runs_away(ARM)
