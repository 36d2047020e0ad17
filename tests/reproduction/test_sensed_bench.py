"""The bench as its sensors show it."""

import numpy as np

from arm.bench import Bench, motions
from arm.kinematics import tip_position
from arm.model import Control
from reproduction.bench_data import true_arm
from reproduction.sensed_bench import sensed_bench, sensed_one_by_one

PD = true_arm().control
RATE_HZ = 8000.0


def test_truth_and_frames_are_of_the_same_instants():
    bench = sensed_bench(PD, 0, 3, 1, rate_hz=RATE_HZ)
    assert [trial.role for trial in bench.sensed] == ["learn"] * 3 + ["evaluate"]
    moved = list(motions(true_arm(), Bench(RATE_HZ, learning=3, evaluating=1), 0))
    for seen, true, motion in zip(bench.sensed, bench.true, moved, strict=True):
        np.testing.assert_array_equal(true.q, motion.q[4::8])
        assert seen.q.shape == true.q.shape
        # half a millisecond at 2 rad/s would be 0.06 deg in what changes from frame to frame
        off = np.diff(seen.q - true.q, axis=0)
        assert np.abs(off).max() < 2e-4
        assert np.rad2deg(np.abs(seen.q - true.q)).max() < 1.0
        assert seen.tau is None


def test_the_tip_is_measured_without_the_arms_lengths():
    bench = sensed_bench(PD, 0, 3, 1, rate_hz=RATE_HZ)
    assert [joint.a_m for joint in bench.arm.joints] == [0.5, 0.5]
    seen, true = bench.sensed[0], bench.true[0]
    moved = tip_position(true_arm(), true.q)
    off = (seen.tip - seen.tip[0]) - (moved - moved[0])
    assert 0.0 < np.linalg.norm(off, axis=1).max() < 0.03


def test_one_recording_a_motion_begins_at_rest():
    bench = sensed_one_by_one(Control("p", (9.5, 9.5)), 0, 2, RATE_HZ)
    assert bench.recognised == len(bench.sensed) == 2
    for seen, true in zip(bench.sensed, bench.true, strict=True):
        np.testing.assert_allclose(true.dq[:400], 0.0, atol=1e-9)
        assert np.rad2deg(np.abs(seen.q - true.q)).max() < 0.5
