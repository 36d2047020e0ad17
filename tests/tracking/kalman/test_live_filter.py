"""The live filter, on filterpy's matrices, against the compiled one, and what it says of gaps."""

from dataclasses import replace

import numpy as np
import pytest

from tracking.kalman.live_filter import LiveFilter
from tracking.model.course import course_of
from tracking.model.initial_state import MountingPrior, start_state
from tracking.model.zero_velocity import WINDOW_S
from tracking.smoother.smoother import Smoother

RATE_HZ = 250.0
GAP = slice(4000, 4400)  # in the middle of the first motion


def live(arm, readings, q0):
    first = readings.values[: round(WINDOW_S / readings.dt_s)]
    return LiveFilter(arm, q0, True, first, readings.noise, readings.factor, readings.dt_s)


def both(arm, readings, q0):
    """Return states and rests of the live filter and of the compiled one."""
    tracker = live(arm, readings, q0)
    states, still = [], []
    for reading in readings.values:
        still.append(tracker.step(reading))
        states.append(tracker.x.copy())
    smoother = Smoother(arm, q0, True)
    of = smoother.observation
    x, P = start_state(arm, of, smoother.size, readings.first, q0, True, MountingPrior())
    compiled, held, _ = smoother._filter(course_of(readings, arm.n_joint), readings, x, P)
    return np.stack(states), np.array(still), compiled, held


@pytest.mark.parametrize("lost", [None, GAP], ids=["whole", "gap"])
@pytest.mark.parametrize("corner_hz", [0.0, 0.2], ids=["DC", "AC"])
def test_it_follows_the_compiled_filter(upright_bench, decimated, lost, corner_hz):
    """The algebra is the same in another order; rounding grows to some 1e-11 rad and 1e-8 rad/s^2.

    The rests are the same. That sensors are held to be AC-coupled makes no difference, whether they are or not.
    """
    arm = upright_bench.arm
    if corner_hz:
        arm = replace(arm, sensors=tuple(replace(s, highpass_hz=corner_hz) for s in arm.sensors))
    readings = decimated(upright_bench, RATE_HZ, lost)
    states, still, compiled, held = both(arm, readings, upright_bench.q[0])
    np.testing.assert_array_equal(still, held)
    np.testing.assert_allclose(states, compiled, rtol=0, atol=1e-6)


def test_it_doubts_as_much_as_the_compiled_filter(upright_bench, decimated):
    """Strokes that no motion explains, in a rest and in a motion."""
    strokes = (90, 900, 1100)
    whole = decimated(upright_bench, RATE_HZ)
    values = whole.values[:1300].copy()
    for k in strokes:
        values[k, k % 12] += 40.0
        values[k, (k + 5) % 12] -= 25.0
    readings = replace(whole, values=values)
    tracker = live(upright_bench.arm, readings, upright_bench.q[0])
    for reading in values:
        tracker.step(reading)
    assert tracker.consistency().doubted == len(strokes)
    states, still, compiled, held = both(upright_bench.arm, readings, upright_bench.q[0])
    np.testing.assert_array_equal(still, held)
    np.testing.assert_allclose(states, compiled, rtol=0, atol=1e-6)


def test_it_begins_slow_though_the_arm_moves(upright_bench, decimated):
    readings = decimated(upright_bench, RATE_HZ)
    begin = int(np.argmax(np.ptp(readings.values[:300], axis=1))) + 60
    moving = replace(readings, values=readings.values[begin:])
    assert moving.begins_in_motion
    P = live(upright_bench.arm, moving, upright_bench.q[0]).state[1]
    np.testing.assert_allclose(np.sqrt(np.diag(P)[1:6:3]), 0.01)


def test_a_lost_reading_is_predicted_and_not_judged(upright_bench, decimated):
    readings = decimated(upright_bench, RATE_HZ)
    tracker = live(upright_bench.arm, readings, upright_bench.q[0])
    for reading in readings.values[:300]:
        tracker.step(reading)
    tracker.consistency()
    before, variance = tracker.x.copy(), tracker.angle_variance.copy()
    assert not tracker.step(np.full(12, np.nan))
    dt = readings.dt_s
    expected = before[:6:3] + dt * before[1:6:3] + dt**2 / 2 * before[2:6:3]
    np.testing.assert_allclose(tracker.x[:6:3], expected, rtol=0, atol=1e-12)
    for _ in range(20):
        tracker.step(np.full(12, np.nan))
    assert (tracker.angle_variance > 1.1 * variance).all()
    assert tracker.consistency().size is None


def test_another_time_from_frame_to_frame_is_gone_on_with(upright_bench, decimated):
    readings = decimated(upright_bench, RATE_HZ)
    same, other = (live(upright_bench.arm, readings, upright_bench.q[0]) for _ in range(2))
    for k, reading in enumerate(readings.values[:400]):
        if k % 100 == 0:
            other.retime(2.0 * readings.dt_s)
            other.retime(readings.dt_s)  # and back
        assert same.step(reading) == other.step(reading)
    np.testing.assert_array_equal(same.x, other.x)
    np.testing.assert_array_equal(same.angle_variance, other.angle_variance)
    before, dt = other.x.copy(), 3.0 * readings.dt_s
    other.retime(dt)
    other.step(np.full(12, np.nan))
    expected = before[:6:3] + dt * before[1:6:3] + dt**2 / 2 * before[2:6:3]
    np.testing.assert_allclose(other.x[:6:3], expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(other.x[1:6:3], before[1:6:3] + dt * before[2:6:3], rtol=0, atol=1e-12)


def test_a_reading_that_no_motion_explains_leaves_the_angles(upright_bench, decimated):
    readings = decimated(upright_bench, RATE_HZ)
    tracker = live(upright_bench.arm, readings, upright_bench.q[0])
    for reading in readings.values[:300]:
        tracker.step(reading)
    tracker.consistency()
    before = tracker.x.copy()
    with np.errstate(all="ignore"):
        tracker.step(np.full(12, np.inf))
    np.testing.assert_array_equal(tracker.x[:6:3], before[:6:3])  # how fast it went then, nobody knows
    np.testing.assert_array_equal(tracker.x[6:], before[6:])
    said = tracker.consistency()
    assert (said.jolts, said.doubted) == (1, 1)
    tracker.step(readings.values[301])
    assert np.isfinite(tracker.x).all()


def test_it_rests_until_the_arm_moves(upright_bench, decimated):
    readings = decimated(upright_bench, RATE_HZ)
    tracker = live(upright_bench.arm, readings, upright_bench.q[0])
    assert tracker.resting
    rests = []
    for reading in readings.values[:500]:
        tracker.step(reading)
        rests.append(tracker.resting)
    moving = np.abs(upright_bench.dq[:: readings.factor][:500]).max(axis=1) > 0.3
    assert all(rests[:100]) and not any(np.array(rests)[moving])


def test_it_rests_again_where_the_arm_does(upright_bench, decimated):
    readings = decimated(upright_bench, RATE_HZ)
    tracker = live(upright_bench.arm, readings, upright_bench.q[0])
    rests = []
    for reading in readings.values:
        tracker.step(reading)
        rests.append(tracker.resting)
    speed = np.abs(upright_bench.dq[:: readings.factor][: len(rests)]).max(axis=1)
    fast = np.flatnonzero(speed > 0.3)
    assert rests[-1] and not any(np.array(rests)[fast])
    assert fast[-1] < len(rests) - 200  # it has moved, and stopped long before the end
