"""Readings of a motion out of the blocks of a stream."""

import numpy as np
import pytest

from fitter.data.felt import REST_S, felt_of


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


def numbered(frame0, n=10, dt_s=0.001, **more):
    """Return a block whose angles, readings and claims tell the number of their frame."""
    number = frame0 + np.arange(n, dtype=float)
    return {
        "frame0": frame0,
        "t0_ns": round(frame0 * dt_s * 1e9),
        "dt_s": dt_s,
        "n": n,
        "q": np.column_stack([number, -number]),
        "q_std": number[:, None] * [0.1, 0.2],
        "a": np.repeat(number[:, None], 3, axis=1),
        "a_noise": np.array([[1e-4 * (1 + frame0)] * 3, [1e-6] * 3]),
        **more,
    }


def test_where_the_arm_rests_is_said_by_the_first_and_last_frame():
    felt = felt_of([numbered(20), numbered(30), numbered(40, 7)], -np.inf, 25_000_000, 90_000_000)
    assert felt.q.tolist() == [20.0, -20.0] and felt.end_q.tolist() == [46.0, -46.0]
    assert felt.q_std.tolist() == [2.0, 4.0]
    assert felt.readings.noise.variance.tolist() == [1e-4 * 41] * 3  # as it is known at last
    assert felt.readings.noise.rounding.tolist() == [1e-6] * 3
    assert len(felt.t_s) == 27 // 4
    np.testing.assert_allclose(felt.readings.values[:, 1], 21.5 + 4.0 * np.arange(6))


@pytest.mark.parametrize(
    ("dt_s", "step"), [(0.001, 4), (0.002, 2), (0.0025, 2), (0.003, 1), (0.004, 1), (0.01, 1), (0.0005, 8)]
)
def test_readings_are_averaged_over_four_milliseconds(dt_s, step):
    felt = felt_of([numbered(0, 20, dt_s)], -np.inf, 0, 10**9)
    assert felt.readings.factor == step and felt.readings.dt_s == step * dt_s
    np.testing.assert_allclose(felt.t_s, dt_s * ((step - 1) / 2 + step * np.arange(20 // step)), atol=1e-12)
    np.testing.assert_allclose(felt.readings.values[0], (step - 1) / 2)
    assert felt.readings.t0_s == 0.0


@pytest.mark.parametrize(("n", "there"), [(7, False), (8, True)])
def test_less_than_two_readings_are_none(n, there):
    assert (felt_of([numbered(0, n)], -np.inf, 0, 10**9) is not None) == there


@pytest.mark.parametrize(
    ("after_ns", "end_ns", "first", "last"),
    [
        (9_999_999, 30_000_000, 10.0, 39.0),
        (10_000_000, 30_000_000, 20.0, 39.0),  # that block is of the motion before
        (10_000_000, 29_999_999, 20.0, 29.0),
        (0.0, 10_000_000, 10.0, 19.0),
    ],
)
def test_blocks_count_from_one_motion_s_end_to_the_next(after_ns, end_ns, first, last):
    felt = felt_of([numbered(k) for k in range(0, 60, 10)], after_ns, 0, end_ns)
    assert (felt.q[0], felt.end_q[0]) == (first, last)


def test_without_a_claim_of_noise_there_is_none():
    blocks = [numbered(0), numbered(10, a_noise=None)]
    assert felt_of(blocks, -np.inf, 0, 10**9) is None
    assert felt_of([numbered(0, a_noise=None), numbered(10)], -np.inf, 0, 10**9) is not None


def test_a_long_rest_counts_for_its_last_seconds():
    felt = felt_of([block(k) for k in range(0, 6000, 10)], -np.inf, 5_000_000_000, 5_900_000_000)
    assert felt.q[0] == 1000.0 * (5.0 - REST_S) + 10.0  # of the first block that begins within them
    assert felt.t_s[0] == pytest.approx(-REST_S + 0.01 + 0.0015)
