"""How much of a coupling is passive."""

import math
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbcal.errors import ConfigError
from playback.touch.limit import (
    Bound,
    Coupling,
    damping_needed,
    mass_limit,
    sampled_interval,
    stiffness_limit,
    wall_limit,
)

UNHURRIED = settings(deadline=None)  # the first call may compile

DEVICE, SHARE, INTERVAL = st.floats(1e-3, 50.0), st.floats(0.01, 0.99), st.floats(1e-4, 0.05)


@UNHURRIED
@given(DEVICE, SHARE, INTERVAL)
def test_limit_and_need_are_each_others_inverse(device: float, share: float, interval_s: float) -> None:
    damping = share * device
    stiffness = stiffness_limit(device, damping, interval_s)
    assert damping_needed(stiffness, damping, interval_s) == pytest.approx(device, rel=1e-9)
    assert stiffness <= stiffness_limit(device, device / 4.0, interval_s) * (1.0 + 1e-12)
    assert stiffness_limit(device, device / 4.0, interval_s) == pytest.approx(device / interval_s)
    assert stiffness <= wall_limit(device, interval_s)


def test_without_damping_nothing_is_passive() -> None:
    assert stiffness_limit(5.0, 0.0, 1e-3) == 0.0
    assert stiffness_limit(0.0, 0.0, 1e-3) == 0.0
    assert damping_needed(1.0, 0.0, 1e-3) == math.inf
    assert damping_needed(0.0, 0.0, 1e-3) == 0.0
    assert wall_limit(0.0, 1e-3) == 0.0
    assert Coupling(device=0.0, wall=(1.0, 0.0, 0.0, 0.0)).within(1e-3).stiffness == 0.0


def test_the_numbers_of_the_paper_of_colgate_and_schenkel() -> None:
    assert wall_limit(5.0, 1e-3) == pytest.approx(10_000.0)  # b > K T / 2
    assert wall_limit(5.0, 1e-3, 3.0) == pytest.approx(4_000.0)  # b > K T / 2 + B


@UNHURRIED
@given(DEVICE, st.floats(0.0, 1e5), st.floats(0.0, 60.0), INTERVAL, st.floats(1e-4, 10.0))
def test_what_is_given_is_passive_and_no_more_than_asked(
    device: float, stiffness: float, damping: float, interval_s: float, mass: float
) -> None:
    asked = Coupling(stiffness, damping, device, wall=(0.0, 0.0, 2.0, 1.0))
    bound = mass_limit(mass, 1e-3)
    given_ = asked.within(interval_s, bound)
    assert given_.stiffness <= min(stiffness, bound.stiffness) and given_.damping <= bound.damping
    needed = damping_needed(given_.stiffness, given_.damping, interval_s)
    assert needed + given_.wall_stiffness * interval_s / 2.0 <= device * (1.0 + 1e-9)
    assert asked.wall == (0.0, 0.0, 1.0, 0.5)
    slower = asked.within(2.0 * interval_s, bound)
    assert slower.stiffness <= given_.stiffness


def test_a_delay_costs_twice_its_length_and_a_light_arm_is_held_loosely() -> None:
    assert sampled_interval(1e-3, 1e-3) == pytest.approx(3e-3)
    light = Coupling(stiffness=1000.0).within(1e-3, mass_limit(1e-4, 1e-3))
    assert (light.stiffness, light.damping) == pytest.approx((100.0, 0.1))


def test_every_mistake_is_said() -> None:
    with pytest.raises(ConfigError) as refused:
        Coupling(stiffness=-1.0, damping=math.nan, wall=(0.0, 0.0, 0.0, 1.0))
    assert len(refused.value.mistakes) == 3


def test_a_coupling_is_what_the_page_of_commands_says_unless_something_else_is_asked_for() -> None:
    page = (Path(__file__).parents[3] / "docs" / "commands.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| (`--[^|]*`) \| ([^|]*) \|", page, re.MULTILINE))
    plain = Coupling()
    assert rows["`--stiffness`, `--damping`"] == f"{plain.stiffness:g} N/m, {plain.damping:g} N s/m"
    assert rows["`--device-damping`"] == f"{plain.device:g} N s/m"


def test_what_is_just_passive_is_given_as_it_was_asked_for() -> None:
    given_ = Coupling(3.0, 0.25, 4.0).within(1.0)  # 4 sqrt(1/4) (sqrt(4) - sqrt(1/4)) = 3
    assert (given_.stiffness, given_.damping) == (3.0, 0.25)
    softer = Coupling(3.1, 0.25, 4.0).within(1.0)
    assert (softer.stiffness, softer.damping) == (3.1, 1.0)  # b/4 leaves 4 N/m
    assert Coupling(9.0, 0.25, 4.0).within(1.0).stiffness == 4.0
    damped = Coupling(0.0, 5.0, 5.0).within(1e-3)
    assert (damped.stiffness, damped.damping) == (0.0, 5.0)
    assert Coupling(0.0, 5.1, 5.0).within(1e-3).damping == 1.25


def test_turning_is_limited_by_itself() -> None:
    asked = Coupling(1.0, 1.0, 5.0, turn_stiffness=3.1, turn_damping=0.25, turn_device=4.0)
    given_ = asked.within(1.0)
    assert (given_.turn_stiffness, given_.turn_damping, given_.stiffness) == (3.1, 1.0, 1.0)
    given_ = asked.within(1.0, inertia=Bound(2.5, 9.0))
    assert (given_.turn_stiffness, given_.turn_damping) == (2.5, 0.25)
    assert given_.stiffness == 1.0


@pytest.mark.parametrize(("asked", "given_"), [(None, 2.0), (1.5, 1.5), (2.5, 2.0), (0.0, 0.0)])
def test_a_wall_gets_what_the_coupling_leaves(asked: float | None, given_: float) -> None:
    # K = 3, B = 1/4, T = 1 need 9/4 + 3/2 + 1/4 = 4 of 5 N s/m; the wall 2 (5 - 4)
    coupling = Coupling(3.0, 0.25, 5.0, wall=(0.0, 1.0, 0.0, 0.0), wall_stiffness=asked)
    assert coupling.within(1.0).wall_stiffness == pytest.approx(given_)


def test_without_a_wall_none_is_stiff() -> None:
    assert Coupling(wall_stiffness=7.0).within(1e-3).wall_stiffness == 0.0
    assert damping_needed(0.0, 3.0, 1e-3) == 3.0
    assert mass_limit(2.0, 0.5) == (8.0, 4.0)
    assert wall_limit(1.0, 1.0, 2.0) == 0.0


@pytest.mark.parametrize("wall", [(math.inf, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, math.nan), (0.0, 0.0, 0.0, 0.0)])
def test_a_wall_has_a_direction_and_a_place(wall: tuple[float, float, float, float]) -> None:
    with pytest.raises(ConfigError, match="expected a normal that is not zero, and an offset"):
        Coupling(wall=wall)
    assert Coupling(wall=(3.0, 0.0, 4.0, 10.0)).wall == pytest.approx((0.6, 0.0, 0.8, 2.0))
