"""Where a motor is in its play, against motions whose link is known."""

from typing import cast

import numpy as np
import pytest

from fitter.data.trial import Trial
from fitter.diagnosis.backlash import BacklashPath, bridged, contact_side

DT, GAP = 0.002, 0.05
T = np.arange(1000) * DT


def pulled_to_and_fro(crossing_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a link that swings, the motor that swings it from both sides, and its torque, with noise."""
    rng = np.random.default_rng(0)
    link, torque = np.sin(5.0 * T), -np.sin(5.0 * T)
    turn = (5.0 * T) % np.pi / 5.0  # time since the torque last changed its sign
    share = np.clip(turn / crossing_s, 0.0, 1.0)
    side = np.where(share < 1.0, (2.0 * share - 1.0) * np.sign(torque), np.sign(torque))
    torque = np.where(share < 1.0, 0.0, torque)
    return link, link + GAP / 2.0 * side, torque + 0.01 * rng.normal(size=len(T))


@pytest.mark.parametrize("crossing_s", [0.004, 0.06])
def test_a_link_is_where_it_is_while_its_motor_crosses(crossing_s):
    link, motor, torque = pulled_to_and_fro(crossing_s)
    bridge, side = bridged(motor, torque, [], DT)
    inside = slice(100, -100)
    off = motor + bridge - GAP / 2.0 * side - link
    assert np.max(np.abs(off[inside])) < 0.05 * GAP


def test_noise_about_zero_touches_nothing():
    torque = 0.01 * np.random.default_rng(0).normal(size=2000)
    np.testing.assert_array_equal(contact_side(torque, 0.01, DT), 0.0)
    np.testing.assert_array_equal(bridged(np.zeros(2000), torque, [], DT), 0.0)


@pytest.mark.parametrize("rests_at", [-1.0, 0.3, 1.0])
def test_a_link_rests_until_it_is_touched_wherever_its_motor_rested(rests_at):
    rng = np.random.default_rng(1)
    start, touch = 500, 503
    acceleration = np.where(np.arange(1000) >= touch, 40.0, 0.0)
    link = np.cumsum(np.cumsum(acceleration)) * DT**2
    side = np.interp(np.arange(1000), [0, start, touch], [rests_at, rests_at, 1.0])
    torque = np.where(np.arange(1000) >= touch, 5.0, 0.0) + 0.01 * rng.normal(size=1000)
    motor = link + GAP / 2.0 * side
    bridge, found = bridged(motor, torque, [start, touch], DT)
    off = motor + bridge - GAP / 2.0 * found - link
    assert np.ptp(off[start - 100 :]) < 0.1 * GAP


@pytest.mark.parametrize("gap", [1e-6, 0.0015, 0.05])
def test_a_link_is_never_further_from_its_motor_than_half_the_gap(gap):
    """A motor that creeps for long by a torque that drowns in noise takes its link along."""
    rng = np.random.default_rng(2)
    shaking = 2e-4
    motor = 0.2 * (1.0 - np.exp(-T / 0.4)) + shaking * rng.normal(size=len(T))
    torque = np.where(T < 0.3, -5e-3, np.where(T > 1.7, 5e-3, 0.0)) + 1e-3 * rng.normal(size=len(T))
    bridge, side = bridged(motor, torque, [], DT)
    assert np.abs(bridge).max() > 0.005
    play = BacklashPath(bridge, side, shaking, cast(Trial, None), 0, 1)
    off = play.off(gap)
    assert np.abs(off).max() <= 0.5 * gap + 4.0 * shaking
