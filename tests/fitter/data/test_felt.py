"""Readings of a motion out of the blocks of a stream."""

import numpy as np

from fitter.data.felt import felt_of


def block(frame0, n=10, **more):
    return {
        "frame0": frame0,
        "t0_ns": frame0 * 1_000_000,
        "dt_s": 0.001,
        "n": n,
        "q": np.full((n, 1), float(frame0)),
        "a": np.repeat(np.arange(frame0, frame0 + n, dtype=float)[:, None], 3, axis=1),
        "a_noise": np.array([[1e-4] * 3, [1e-6] * 3]),
        **more,
    }


def test_readings_are_means_over_a_step():
    felt = felt_of([block(k) for k in range(0, 100, 10)], -np.inf, 30_000_000, 90_000_000)
    np.testing.assert_allclose(felt.readings.values[:, 0], 1.5 + 4.0 * np.arange(25))
    np.testing.assert_allclose(felt.t_s, -0.03 + 0.0015 + 0.004 * np.arange(25))
    np.testing.assert_allclose(felt.readings.noise.of_mean(felt.readings.factor), 1e-4 / 4 + 1e-6)
    assert (felt.q[0], felt.end_q[0], felt.q_std) == (0.0, 90.0, None)


def test_what_belongs_to_the_motion_before_is_left_out():
    felt = felt_of([block(k) for k in range(0, 100, 10)], 35e6, 50_000_000, 90_000_000)
    assert felt.q[0] == 40.0


def test_missing_frames_are_not_a_number():
    felt = felt_of([block(k) for k in range(0, 100, 10) if k != 40], -np.inf, 0, 90_000_000)
    lost = np.isnan(felt.readings.values[:, 0])
    assert lost[10:12].all() and not lost[:10].any() and not lost[13:].any()


def test_a_stream_without_readings_has_none():
    blocks = [block(k) for k in range(0, 100, 10)]
    del blocks[3]["a"]
    assert felt_of(blocks, -np.inf, 0, 90_000_000) is None
    assert felt_of([], -np.inf, 0, 90_000_000) is None
