"""How far and fast joints turn, and in which unit that is."""

import numpy as np
import pytest

from protocol.tables.turning import look_like_degrees, top_speeds, turning_likelihood

T = np.linspace(0.0, 2.0, 201)
SWING = np.column_stack([np.sin(3.0 * T), np.cos(2.0 * T)])  # two radians to and fro, at up to 3 rad/s


def test_a_limb_in_degrees_is_seen_and_one_in_radians_is_not() -> None:
    assert look_like_degrees(T, np.degrees(SWING))
    assert not look_like_degrees(T, SWING)
    assert not look_like_degrees(T, 0.0 * SWING)  # what stands still says nothing


def test_a_wheel_may_turn_far() -> None:
    assert not look_like_degrees(T, 10.0 * T[:, None])


def test_a_limb_is_likelier_to_swing_by_one_radian_than_by_a_hundred() -> None:
    one, hundred = (turning_likelihood(np.array([k]), np.array([2.0 * k])) for k in (1.0, 100.0))
    assert one > hundred + np.log(100.0)


@pytest.mark.parametrize("rate_hz", [50.0, 10_000.0])
def test_the_top_speed_is_neither_a_jump_nor_an_encoder_s_step(rate_hz: float) -> None:
    t = np.arange(0.0, 4.0, 1.0 / rate_hz)
    q = np.column_stack([2.0 * t, -0.5 * t])
    if rate_hz > 1e3:
        q = np.round(q / 1e-3) * 1e-3
    q[len(t) // 2 :] += 30.0
    assert top_speeds(t, q) == pytest.approx([2.0, 0.5], rel=0.15)


@pytest.mark.parametrize(("rows", "coarse"), [(800, 1), (801, 2), (1201, 3)])
def test_top_speeds_are_those_over_a_four_hundredth_of_the_table(rows: int, coarse: int) -> None:
    """An encoder that steps by 1 every second sample goes half as fast over two; 95 in 100 are no faster."""
    t = 0.5 * np.arange(float(rows))
    q = np.stack([np.floor(np.arange(rows) / 2.0), np.arange(rows) ** 2.0], axis=1)
    steps = np.abs(np.diff(q[::coarse], axis=0)) / (0.5 * coarse)
    assert top_speeds(t, q) == pytest.approx(np.sort(steps, axis=0)[round(0.95 * (len(steps) - 1))], rel=2e-3)
    assert top_speeds(t, q)[0] == {1: 2.0, 2: 1.0, 3: 4.0 / 3.0}[coarse]
