"""How a link moves while its motor crosses, against motions whose link is known."""

import numpy as np
import pytest

from fitter.diagnosis.link_coasting import coasting, contact_side

DT, GAP, SHAKING = 0.002, 0.05, 1e-6
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
    found = coasting(motor, torque, (SHAKING, 0.01), [], DT)
    inside = slice(100, -100)
    off = motor + found.bridge - GAP / 2.0 * found.side - link
    assert np.max(np.abs(off[inside])) < 0.05 * GAP


def test_noise_about_zero_touches_nothing():
    torque = 0.01 * np.random.default_rng(0).normal(size=2000)
    np.testing.assert_array_equal(contact_side(torque, 0.01, DT), 0.0)
    found = coasting(np.zeros(2000), torque, (SHAKING, 0.01), [], DT)
    for column in (found.bridge, found.variance, found.side):
        np.testing.assert_array_equal(column, 0.0)


@pytest.mark.parametrize("rests_at", [-1.0, 0.3, 1.0])
def test_a_link_rests_until_it_is_touched_wherever_its_motor_rested(rests_at):
    rng = np.random.default_rng(1)
    start, touch = 500, 503
    acceleration = np.where(np.arange(1000) >= touch, 40.0, 0.0)
    link = np.cumsum(np.cumsum(acceleration)) * DT**2
    side = np.interp(np.arange(1000), [0, start, touch], [rests_at, rests_at, 1.0])
    torque = np.where(np.arange(1000) >= touch, 5.0, 0.0) + 0.01 * rng.normal(size=1000)
    motor = link + GAP / 2.0 * side
    found = coasting(motor, torque, (SHAKING, 0.01), [start, touch], DT)
    off = motor + found.bridge - GAP / 2.0 * found.side - link
    assert np.ptp(off[start - 100 :]) < 0.1 * GAP


def test_a_bridge_is_off_by_its_variance():
    """A hundred noises of one crossing: the scatter of the bridged angle is what its variance says."""
    link, motor, torque = pulled_to_and_fro(0.06)
    noise_rad, rng = 1e-3, np.random.default_rng(3)
    drawn = []
    for _ in range(100):
        noisy = motor + noise_rad * rng.normal(size=len(T))
        found = coasting(noisy, torque, (noise_rad, 0.01), [], DT)
        drawn.append(noisy + found.bridge)
    inside = (found.bridge != 0.0) & (np.abs(T - 0.5 * T[-1]) < 0.4 * T[-1])
    inside &= np.roll(inside, -1)  # the last angle of a crossing is a measured one
    scatter = np.var(drawn, axis=0)[inside] / noise_rad**2
    assert np.median(scatter / found.variance[inside]) == pytest.approx(1.0, abs=0.3)
