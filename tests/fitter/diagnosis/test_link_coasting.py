"""How a link moves while its motor crosses, against motions whose link is known."""

import numpy as np
import pytest

from fitter.diagnosis.contacts import Motor
from fitter.diagnosis.free_link import FreeLink
from fitter.diagnosis.link_coasting import coasting

DT, GAP, SHAKING = 0.002, 0.05, 1e-6
T = np.arange(1000) * DT


def link_of(acceleration: np.ndarray, torque: np.ndarray) -> FreeLink:
    """Return a link of inertia 1 that accelerates like that under a torque."""
    return FreeLink(T, np.ones(len(T)), torque - acceleration, 0.0, 0.0, 0.0)


def pulled_to_and_fro(crossing_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, FreeLink]:
    """Return a link that swings, the motor that swings it from both sides, its noisy torque, and its forces."""
    rng = np.random.default_rng(0)
    link, torque = np.sin(5.0 * T), -np.sin(5.0 * T)
    turn = (5.0 * T) % np.pi / 5.0  # time since the torque last changed its sign
    share = np.clip(turn / crossing_s, 0.0, 1.0)
    side = np.where(share < 1.0, (2.0 * share - 1.0) * np.sign(torque), np.sign(torque))
    torque = np.where(share < 1.0, 0.0, torque)
    moved = link_of(-25.0 * link, torque)
    return link, link + GAP / 2.0 * side, torque + 0.01 * rng.normal(size=len(T)), moved


@pytest.mark.parametrize("crossing_s", [0.004, 0.06])
def test_a_link_is_where_it_is_while_its_motor_crosses(crossing_s):
    link, motor, torque, moved = pulled_to_and_fro(crossing_s)
    found = coasting(Motor(motor, torque, (SHAKING, 0.01), [], moved, DT))
    inside = slice(100, -100)
    off = motor + found.bridge - GAP / 2.0 * found.side - link
    assert np.max(np.abs(off[inside])) < 0.05 * GAP


def test_a_long_crossing_is_no_cubic_and_a_stop_by_friction_is_seen():
    """A link that its friction stops within its gap stays where it is until its motor comes back for it."""
    speed, braked = 0.2, 2.0
    since = np.clip(T - 0.6, 0.0, speed / braked)
    link = speed * np.minimum(T, 0.6) + speed * since - 0.5 * braked * since**2
    torque = np.where(T < 0.6, braked, np.where(T >= 1.4, -braked / 2.0, 0.0))
    side = np.interp(T, [0.6, 1.4], [1.0, -1.0])
    moved = FreeLink(T, np.ones(len(T)), np.zeros(len(T)), 0.0, braked, 0.0)
    motor = link + GAP / 2.0 * side
    noisy = torque + 0.01 * np.random.default_rng(0).normal(size=len(T))
    found = coasting(Motor(motor, noisy, (SHAKING, 0.01), [], moved, DT))
    off = motor + found.bridge - GAP / 2.0 * found.side - link
    assert np.max(np.abs(off[100:-100])) < 0.05 * GAP


def test_noise_about_zero_crosses_nothing():
    torque = 0.01 * np.random.default_rng(0).normal(size=len(T))
    found = coasting(Motor(np.zeros(len(T)), torque, (SHAKING, 0.01), [], link_of(0.0 * T, 0.0 * T), DT))
    for column in (found.bridge, found.variance, found.side):
        np.testing.assert_array_equal(column, 0.0)


@pytest.mark.parametrize("rests_at", [-1.0, 0.3, 1.0])
def test_a_link_rests_until_it_is_touched_wherever_its_motor_rested(rests_at):
    rng = np.random.default_rng(1)
    start, touch = 500, 503
    acceleration = np.where(np.arange(1000) >= touch, 40.0, 0.0)
    link = np.cumsum(np.cumsum(acceleration)) * DT**2
    side = np.interp(np.arange(1000), [0, start, touch], [rests_at, rests_at, 1.0])
    torque = np.where(np.arange(1000) >= touch, 40.0, 0.0)
    moved, motor = link_of(acceleration, torque), link + GAP / 2.0 * side
    noisy = torque + 0.01 * rng.normal(size=1000)
    found = coasting(Motor(motor, noisy, (SHAKING, 0.01), [start, touch], moved, DT))
    off = motor + found.bridge - GAP / 2.0 * found.side - link
    assert np.ptp(off[start - 100 :]) < 0.1 * GAP


@pytest.mark.parametrize("lacking", [0.0, 0.3])
def test_a_bridge_is_off_by_its_variance(lacking):
    """A hundred noises of one crossing: the scatter of the bridged angle is what its variance says.

    What acceleration the model lacks is white noise of the density that its variance over a fifth of a second has.
    """
    link, motor, torque, moved = pulled_to_and_fro(0.06)
    noise_rad, rng = 1e-3, np.random.default_rng(3)
    moved = FreeLink(moved.t, moved.inertia, moved.resistance, 0.0, 0.0, lacking)
    off = []
    for _ in range(100):
        noisy = motor + noise_rad * rng.normal(size=len(T))
        found = coasting(Motor(noisy, torque, (noise_rad, 0.01), [], moved, DT))
        off.append(noisy + found.bridge)
    inside = (found.bridge != 0.0) & (np.abs(T - 0.5 * T[-1]) < 0.4 * T[-1])
    scatter = np.var(off, axis=0)[inside] / noise_rad**2
    assert np.median(scatter / found.variance[inside]) < 1.3
    if not lacking:
        assert np.median(scatter / found.variance[inside]) > 0.7
