"""Frames are plain means, and say how well they are known."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.data.raw import RawRun
from fitter.reading_diagnosis.sensor_frames import FRAME_RATE_HZ, trials_of
from limbcal.errors import DataError


@pytest.fixture(scope="module")
def frames(measured_run):
    return trials_of(measured_run.arm, measured_run.learn)


def test_a_frame_is_the_mean_of_its_readings_on_the_runs_clock(frames, measured_run):
    run, one = measured_run.learn[0], frames[0]
    assert one.factor == round(run.rate_hz / FRAME_RATE_HZ) == 10
    n = len(run.a) // 10
    np.testing.assert_allclose(one.values, run.a[: 10 * n].reshape(n, 10, -1).mean(axis=1))
    np.testing.assert_allclose(one.t, run.t[: 10 * n].reshape(n, 10).mean(axis=1))
    assert frames[1].continues and frames[1].start_s == pytest.approx(measured_run.learn[1].t[0])


def test_white_noise_of_a_mean_is_less_by_the_root_of_its_number(frames):
    np.testing.assert_allclose(frames[0].std, 0.02 / np.sqrt(10.0), rtol=0.15)


def test_the_arm_rests_for_half_a_second_at_first(frames):
    assert all(0.3 < one.resting * one.dt_s < 0.7 for one in frames)


def test_what_was_lost_counts_nothing(measured_run):
    run = measured_run.learn[0]
    a = run.a.copy()
    a[1000:1010, 3:6] = np.nan
    (one,) = trials_of(measured_run.arm, [replace(run, a=a)])
    assert not one.weight[100, 3:6].any() and one.weight[100, 6:9].all() and one.weight[101].all()


def test_a_ramp_that_is_read_late_is_put_back(measured_run):
    run = measured_run.learn[0]
    ramp = np.outer(run.t, np.arange(1.0, run.a.shape[1] + 1.0))
    one = replace(trials_of(measured_run.arm, [run])[0], raw=replace(run, a=ramp))
    late = one.advanced(1, 0.0123)
    expected = np.outer(one.t + 0.0123, [4.0, 5.0, 6.0])
    np.testing.assert_allclose(late[:-2], expected[:-2], atol=1e-9)


def test_a_jump_is_known_to_half_its_share_of_a_frame(measured_run):
    run = measured_run.learn[0]
    a = run.a.copy()
    a[1504:, 0] += 10.0
    (one,) = trials_of(measured_run.arm, [replace(run, a=a)])
    assert 1.0 / one.weight[150, 0] == pytest.approx(0.5 * 10.0 / 10, rel=0.05)


def test_a_fast_motion_has_no_jumps(measured_run):
    """Ten samples a period change much from one to the next, and so do their neighbours."""
    run = measured_run.learn[0]
    n = len(run.t) // 10
    wave = np.sin(2.0 * np.pi * 10.0 * 0.01 * np.arange(n))[:, None] * np.arange(1.0, 13.0)
    slow = RawRun("slow", 100.0, 0.01 * np.arange(n), wave + 0.02 * np.random.default_rng(0).normal(size=(n, 12)))
    (one,) = trials_of(measured_run.arm, [slow])
    assert one.factor == 1
    np.testing.assert_allclose(one.weight, np.broadcast_to(1.0 / one.std, one.weight.shape))


def test_where_a_clock_starts_anew_the_arm_may_have_moved(measured_run):
    first, second = measured_run.learn[:2]
    anew = trials_of(measured_run.arm, [first, replace(second, t=second.t - second.t[0])])
    assert [one.continues for one in anew] == [False, False]
    assert anew[1].start_s == pytest.approx(first.t[-1] + 1.0 / first.rate_hz)  # one after the other all the same


def test_readings_have_three_columns_a_sensor(measured_run):
    run = measured_run.learn[0]
    narrow = RawRun("narrow", run.rate_hz, run.t, run.a[:, :5])
    with pytest.raises(DataError, match="5 channels, expected 12"):
        trials_of(measured_run.arm, [narrow])
