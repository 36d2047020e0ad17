"""When the live tracker begins, how long its frames are, and what it counts: at the edges, and at rest."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from tracking.kalman.kalman_filter import KalmanTracker
from tracking.model.innovation_test import Consistency

ARM = load_arm("dd-arm")
MS = 1_000_000


def at_rest(n, seed=0):
    still = np.tile([0.0, 0.0, 9.80665], len(ARM.sensors))
    return still + np.random.default_rng(seed).normal(0.0, 0.02, (n, 12))


def n_frames(frames):
    return sum(len(part.q) for part in frames)


# Of 1 ms: 25 cells of 10 frames. Of 4 ms: 31 cells of 2, the last at sample 61 * 4 + 2, low-passed over 6 more.
@pytest.mark.parametrize(("frame_rate_hz", "samples", "frames"), [(1000.0, 250, 250), (250.0, 253, 62)])
@pytest.mark.parametrize("cut", [1, 100])
def test_it_begins_when_a_quarter_of_a_second_of_frames_is_there(frame_rate_hz, samples, frames, cut):
    tracker, readings = KalmanTracker(ARM, 1000.0, np.zeros(2), frame_rate_hz), at_rest(samples)
    assert tracker.push(0, readings[:cut]) == ([], [])
    assert tracker.push(cut * MS, readings[cut : samples - 1]) == ([], [])
    assert tracker.consistency() == Consistency(None, 0, 0, False)
    found, phases = tracker.push((samples - 1) * MS, readings[samples - 1 :])
    assert (n_frames(found), phases) == (frames, [])
    assert tracker.consistency().size is not None


@pytest.mark.parametrize(
    ("rate_hz", "frame_rate_hz", "dt_s"),
    [(1000.0, 250.0, 0.004), (1000.0, 300.0, 0.003), (1000.0, 5000.0, 0.001), (100.0, 1000.0, 0.01)],
)
def test_frames_are_whole_samples_apart(rate_hz, frame_rate_hz, dt_s):
    tracker = KalmanTracker(ARM, rate_hz, np.zeros(2), frame_rate_hz)
    assert tracker.dt_s == pytest.approx(dt_s, rel=1e-12)
    tracker.push(0, at_rest(400))
    found, _ = tracker.push(round(400e9 / rate_hz), at_rest(100))
    assert [part.dt_s for part in found] == [tracker.dt_s]
    tracker.retime(2.0 * rate_hz)
    assert tracker.dt_s == pytest.approx(dt_s / 2.0, rel=1e-12)


def test_by_default_frames_are_a_thousand_a_second():
    assert KalmanTracker(ARM, 4000.0, None).dt_s == 1e-3


@pytest.mark.parametrize(("samples", "frames"), [(7, 0), (8, 2), (9, 2), (12, 3)])
def test_at_the_end_eight_readings_are_enough(samples, frames):
    tracker = KalmanTracker(ARM, 1000.0, np.zeros(2), 250.0)
    tracker.push(0, at_rest(samples))
    found, phases = tracker.flush()
    assert (n_frames(found), phases) == (frames, [])


def test_a_frame_has_the_time_of_its_own_sample():
    tracker = KalmanTracker(ARM, 1000.0, np.zeros(2), 250.0)
    t0_ns = 1_700_000_000_000_000_123
    (first,), _ = tracker.push(t0_ns, at_rest(300))
    assert (first.frame0, first.t0_ns) == (0, t0_ns + 2 * MS)
    (second,), _ = tracker.push(t0_ns + 5000 * MS, at_rest(100))  # later than its number says: its own time counts
    sample = 4 * second.frame0 + 2
    assert second.frame0 == first.n and second.t0_ns == t0_ns + (5000 + sample - 300) * MS
    assert not first.gap and not second.gap


@pytest.mark.parametrize(("lost", "after"), [(0, 0), (1, 0), (3, 1), (40, 10)])
def test_samples_lost_before_it_began_are_counted(lost, after):
    tracker = KalmanTracker(ARM, 1000.0, np.zeros(2), 250.0)
    assert tracker.gap(lost) == ([], [])
    (first, *_), _ = tracker.push(lost * MS, at_rest(400))
    assert first.gap and first.frame0 == after
    assert first.t0_ns == (4 * first.frame0 + 2) * MS


def test_an_arm_at_rest_stays_where_it_is_said_to_be():
    tracker = KalmanTracker(ARM, 1000.0, np.array([0.3, -0.4]), 250.0)
    (first,), phases = tracker.push(0, at_rest(2000))
    assert phases == []
    np.testing.assert_allclose(first.q, np.tile([0.3, -0.4], (first.n, 1)), rtol=0, atol=0.02)
    assert np.abs(first.dq).max() < 0.05
    np.testing.assert_allclose(first.points, 0.0, rtol=0, atol=1e-3)
    assert (first.q_std > 0.0).all() and first.q_std.shape == (first.n, 2)
    assert KalmanTracker.method == "filter"


def test_what_is_given_is_not_changed():
    q0, readings = np.array([0.3, -0.4]), at_rest(600)
    given = q0.copy(), readings.copy()
    tracker = KalmanTracker(ARM, 1000.0, q0, 250.0)
    tracker.push(0, readings)
    tracker.flush()
    np.testing.assert_array_equal(q0, given[0])
    np.testing.assert_array_equal(readings, given[1])
