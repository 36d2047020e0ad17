"""When the integrator's frames come, and what it makes of rest, motion and gaps, in few samples."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from tracking.dead_reckoning.integrator import Integrator

ARM = load_arm("dd-arm")
MS = 1_000_000
STILL = [0.0, 0.0, 9.80665] * 4


def at_rest(n):
    return np.tile(STILL, (n, 1))


def n_frames(frames):
    return sum(part.n for part in frames)


def test_a_cell_of_10_ms_is_waited_for_and_its_last_frame_for_the_next():
    tracker = Integrator(ARM, 1000.0, np.zeros(2))
    assert tracker.push(0, at_rest(9)) == ([], [])
    counts = [n_frames(tracker.push((9 + k) * MS, at_rest(1))[0]) for k in range(12)]
    assert counts == [9, *[0] * 9, 10, 0]
    frames, phases = tracker.flush()
    assert (n_frames(frames), phases) == (2, [])


@pytest.mark.parametrize(
    ("rate_hz", "frame_rate_hz", "decimation", "cell"),
    [
        (1000.0, 1000.0, 1, 10),
        (1000.0, 500.0, 2, 10),
        (1000.0, 300.0, 3, 9),
        (1000.0, 20.0, 50, 50),
        (100.0, 1000.0, 1, 2),  # one reading shows no noise
        (32000.0, 1000.0, 32, 320),
    ],
)
def test_frames_and_cells_are_of_whole_samples(rate_hz, frame_rate_hz, decimation, cell):
    tracker = Integrator(ARM, rate_hz, np.zeros(2), frame_rate_hz)
    assert tracker.dt_s == pytest.approx(decimation / rate_hz)
    t0_ns, n = 10**18 + 7, 4 * cell
    assert tracker.push(t0_ns, at_rest(cell - 1)) == ([], [])
    frames = tracker.push(t0_ns + round((cell - 1) * 1e9 / rate_hz), at_rest(n - cell + 1))[0] + tracker.flush()[0]
    assert n_frames(frames) == len(range(decimation // 2, n, decimation))
    at = [part.frame0 for part in frames]
    assert at == np.cumsum([0, *(part.n for part in frames)])[:-1].tolist()
    for part in frames:
        sample = part.frame0 * decimation + decimation // 2 - 1.5  # the moving average of four looks back
        assert abs(part.t0_ns - t0_ns - sample * 1e9 / rate_hz) <= 2.0
        np.testing.assert_array_equal(part.q, 0.0)
        assert part.q_std is None and not part.gap


@pytest.mark.parametrize("zero", ["each-rest", "first-rest"])
def test_a_motion_begins_and_ends_and_rest_is_zero_where_it_is_asked_for(glided, tracked, zero):
    recording = glided(ARM, 1000.0, (0.6, -0.9))
    result = tracked(recording, zero=zero)
    begin = result.phases[0]
    assert (begin.kind, begin.trial) == ("begin", 1) and 0.49e9 <= begin.t_ns <= 0.62e9
    assert np.abs(result.q - result.truth()).max() < 0.01
    assert np.abs(result.dq - result.truth("dq")).max() < 0.03
    assert {phase.trial for phase in result.phases} == {1}
    np.testing.assert_array_equal(result.q[:480], 0.0)


@pytest.mark.parametrize("lost", [1, 10, 137])
def test_over_a_gap_a_moving_arm_goes_on_and_a_resting_one_does_not(glided, lost):
    recording = glided(ARM, 1000.0, (0.6, -0.9))
    for at, moves in ((300, False), (1200, True)):
        tracker = Integrator(ARM, 1000.0, np.zeros(2))
        before = tracker.push(0, recording.readings[:at])[0] + tracker.gap(lost)[0]
        assert n_frames(before) == at
        after, _ = tracker.push((at + lost) * MS, recording.readings[at + lost :])
        assert after[0].gap and not any(part.gap for part in [*before, *after[1:]])
        assert after[0].frame0 == at + lost and after[0].t0_ns == round((at + lost - 1.5) * MS)
        step = after[0].q[0] - before[-1].q[-1]
        expected = (lost + 1) * 1e-3 * before[-1].dq[-1]
        assert (np.abs(before[-1].dq[-1]).max() > 0.3) == moves
        np.testing.assert_allclose(step, expected, rtol=0, atol=1e-3 + 0.01 * moves)


def test_another_rate_is_gone_on_with():
    tracker = Integrator(ARM, 1000.0, np.zeros(2))
    tracker.push(0, at_rest(100))
    tracker.retime(500.0)
    assert tracker.dt_s == 0.002
    (part,), _ = tracker.push(100 * MS, at_rest(10))
    assert part.dt_s == 0.002 and part.frame0 == 99


def test_what_is_given_is_not_changed_and_may_be_changed_afterwards():
    q0, readings = np.array([0.3, -0.4]), at_rest(15)
    tracker = Integrator(ARM, 1000.0, q0)
    tracker.push(0, readings)
    np.testing.assert_array_equal(readings, at_rest(15))
    q0[:], readings[:] = 9.0, 1e6
    frames = tracker.push(15 * MS, at_rest(5))[0] + tracker.flush()[0]
    np.testing.assert_array_equal(np.vstack([part.q for part in frames]), np.tile([0.3, -0.4], (11, 1)))
