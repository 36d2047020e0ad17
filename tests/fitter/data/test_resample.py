"""Uniform grids out of uneven stamps."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline, PchipInterpolator

from fitter.data.derivatives import lowpass
from fitter.data.motions import Measured
from fitter.data.resample import resample, split_at_holes, time_step
from limbcal.errors import ConfigError, DataError


def measured(t, **columns):
    return Measured("run", "run.csv", 0, np.asarray(t, dtype=float), columns)


def sine(t, hz=2.0):
    return np.column_stack([np.sin(2 * np.pi * hz * t), np.cos(2 * np.pi * hz * t)])


@pytest.mark.parametrize("dt_s", [0.001, 0.002, 1 / 32000, 0.0125, 1 / 3])
def test_an_even_clock_keeps_its_samples(dt_s):
    t = 12.5 + dt_s * np.arange(1000)
    q = np.random.default_rng(0).normal(size=(1000, 2))
    uniform = resample(measured(t, q=q))
    assert uniform.measured.columns["q"] is q
    assert uniform.measured.notes == ()
    assert np.isclose(uniform.dt_s, dt_s, rtol=1e-5)
    assert uniform.measured.t[0] == 0.0


def test_stamps_off_the_grid_by_less_than_a_millisecond_were_not_rounded_to_one():
    t = 0.01 * np.arange(500) + np.random.default_rng(0).uniform(-4e-4, 4e-4, 500)
    assert not time_step(t)[1]
    assert time_step(np.round(0.0105 * np.arange(500), 3))[1]  # off by half a millisecond each, as rounding says


def test_stamps_rounded_in_a_text_file_are_an_even_clock():
    for rate_hz, decimals in ((32000, 6), (480, 3), (10, 1)):
        step, uniform = time_step(np.round(3.0 + np.arange(5000) / rate_hz, decimals))
        assert uniform
        assert np.isclose(step, 1 / rate_hz, rtol=1e-3)


def test_uneven_stamps_in_few_digits_are_no_even_clock():
    t = np.round(np.cumsum(np.random.default_rng(0).uniform(0.008, 0.012, 500)), 3)
    assert not time_step(t)[1]


def test_the_step_of_an_uneven_clock_is_the_median_in_few_digits():
    t = np.concatenate([[0.0], np.cumsum(np.r_[0.0037, np.full(500, 0.002000093)])])
    assert time_step(t) == (0.002, False)


@given(st.floats(0.0, 0.9), st.integers(0, 2**32 - 1), st.floats(0.5, 5.0))
@example(3.334e-4, 5, 5.0)
def test_a_smooth_motion_survives_uneven_stamps(jitter, seed, hz):
    steps = 0.002 * (1 + jitter * np.random.default_rng(seed).uniform(-0.8, 0.8, 1000))
    t = np.concatenate([[0.0], np.cumsum(steps)])
    uniform = resample(measured(t, q=sine(t, hz)), rate_hz=500.0)
    off = np.abs(uniform.measured.columns["q"] - sine(uniform.measured.t, hz)).max()
    # stamps of a clock that counts as even are off by a twohundredth of a step, and so may its grid be
    assert off < 1e-4 + 2.0 * np.pi * hz * 0.002 / 100.0
    assert np.allclose(np.diff(uniform.measured.t), 0.002)


@given(st.sampled_from([125.0, 200.0, 333.0, 1000.0, 1500.0]), st.floats(0.5, 5.0))
def test_a_band_limited_motion_is_the_same_at_another_rate(rate_hz, hz):
    t = 0.002 * np.arange(1000)
    uniform = resample(measured(t, q=sine(t, hz), tau=sine(t, hz)), rate_hz=rate_hz)
    assert uniform.dt_s == 1 / rate_hz
    inner = (uniform.measured.t > 0.1) & (uniform.measured.t < uniform.measured.t[-1] - 0.1)
    for role, bound in (("q", 1e-4), ("tau", 2e-3)):
        difference = uniform.measured.columns[role] - sine(uniform.measured.t, hz)
        assert np.abs(difference[inner]).max() < bound


def test_a_lower_rate_does_not_fold_what_it_cannot_carry():
    t = 0.001 * np.arange(4000)
    disturbed = sine(t, 1.0) + sine(t, 90.0)
    uniform = resample(measured(t, q=disturbed), rate_hz=100.0)
    assert np.abs(uniform.measured.columns["q"] - sine(uniform.measured.t, 1.0))[20:-20].max() < 5e-3


def test_a_target_that_jumps_does_not_overshoot():
    t = np.cumsum(np.random.default_rng(3).uniform(0.5, 1.5, 300)) * 0.01
    step = np.where(t > 1.0, 2.0, -1.0)[:, None]
    uniform = resample(measured(t, ref=step, tau=step))
    for role in ("ref", "tau"):
        values = uniform.measured.columns[role]
        assert values.min() > -1.0 - 1e-12 and values.max() < 2.0 + 1e-12


def test_crowded_stamps_do_not_make_the_curve_swing_out():
    t = np.sort(np.concatenate([0.01 * np.arange(200), 0.01 * np.arange(0, 200, 7) + 1e-6]))
    noisy = np.random.default_rng(0).uniform(-1, 1, (len(t), 1))
    assert np.abs(resample(measured(t, q=noisy), rate_hz=333.0).measured.columns["q"]).max() <= 1.0


def uneven(n=200):
    return np.cumsum(np.random.default_rng(5).uniform(0.5, 1.5, n)) * 0.01


@pytest.mark.parametrize("rate_hz", [40.0, 250.0])
def test_switches_and_gains_are_those_of_the_nearest_sample(rate_hz):
    t = uneven() - uneven()[0]
    on = (np.arange(200) % 3 > 0).astype(float)[:, None]
    gain = np.random.default_rng(6).normal(size=(200, 2))
    uniform = resample(measured(t, q=sine(t), on=on, kp=gain, kv=-gain), rate_hz=rate_hz).measured
    if rate_hz > 100.0:
        nearest = np.abs(uniform.t[:, None] - t).argmin(axis=1)
        np.testing.assert_array_equal(uniform.columns["on"], on[nearest])
        np.testing.assert_array_equal(uniform.columns["kp"], gain[nearest])
        np.testing.assert_array_equal(uniform.columns["kv"], -gain[nearest])
    assert set(np.unique(uniform.columns["on"])) == {0.0, 1.0}  # nothing in between, however low the rate
    assert np.isin(uniform.columns["kp"], gain).all()


def test_a_target_goes_straight_from_sample_to_sample():
    t = uneven() - uneven()[0]
    ref = np.random.default_rng(6).normal(size=(200, 2))
    uniform = resample(measured(t, ref=ref), rate_hz=250.0).measured
    expected = np.column_stack([np.interp(uniform.t, t, column) for column in ref.T])
    np.testing.assert_allclose(uniform.columns["ref"], expected, rtol=0, atol=1e-9)
    assert t[-1] - 1.0 / 250.0 < uniform.t[-1] <= t[-1]


def test_the_grid_begins_at_the_first_stamp():
    t = uneven() - uneven()[0]
    early, late = (resample(measured(t + begun, q=sine(t), ref=sine(t))) for begun in (0.0, 1234.5))
    assert (early.began_s, late.began_s) == (0.0, 1234.5)
    assert early.measured.t[0] == late.measured.t[0] == 0.0
    for role in ("q", "ref"):
        np.testing.assert_allclose(late.measured.columns[role], early.measured.columns[role], rtol=0, atol=1e-6)


def test_resampling_is_said():
    t = np.concatenate([0.01 * np.arange(50), 0.505 + 0.01 * np.arange(50)])
    (note,) = resample(measured(t, q=sine(t))).measured.notes
    assert note.text == "irregular steps of 10 to 15 ms resampled to 10 ms"


def test_too_few_samples_and_wrong_rates():
    with pytest.raises(DataError, match="run.csv: trial 'run' has 5 samples, expected at least 16"):
        resample(measured(np.arange(5.0), q=np.zeros((5, 1))))
    with pytest.raises(DataError, match="2 samples at 1 Hz"):
        resample(measured(0.1 * np.arange(20), q=np.zeros((20, 1))), rate_hz=1.0)
    with pytest.raises(ConfigError, match="run.csv has 10 rows a second, expected at most 100 times that"):
        resample(measured(0.1 * np.arange(20), q=np.zeros((20, 1))), rate_hz=1e9)
    with pytest.raises(ConfigError, match="rate_hz is -1"):
        resample(measured(np.arange(20.0), q=np.zeros((20, 1))), rate_hz=-1.0)


def test_a_hole_parts_a_motion_and_nothing_is_made_up():
    t = np.concatenate([np.arange(100), 500 + np.arange(50), 700 + np.arange(5)]) * 0.01
    first, second = split_at_holes(measured(t, q=t[:, None]))
    assert (len(first.t), len(second.t)) == (100, 50)
    assert second.first_row == 100
    assert second.name == "run#2"
    (note,) = second.notes
    assert note.text == (
        "in row 101 t goes from 0.99 to 5 s: parted at 2 hole(s) of up to 4.01 s, 2 piece(s) kept"
    )
    assert (note.row, note.from_s, note.to_s) == (101, 0.99, 5.0)
    whole = measured(0.01 * np.arange(9), q=np.zeros((9, 1)))
    assert split_at_holes(whole) == [whole]


def test_a_torque_that_is_next_to_nothing_is_drawn_through():
    t = np.cumsum(np.random.default_rng(4).uniform(0.5, 1.5, 100)) * 0.01
    tau = np.where(t > 0.5, 1e-310 * np.arange(100), np.sin(9.0 * t))[:, None]
    uniform = resample(measured(t, q=sine(t), tau=tau))
    assert np.all(np.abs(uniform.measured.columns["tau"]) <= 1.0)


@pytest.mark.parametrize(("step", "pieces"), [(0.0999, [60]), (0.1001, [40, 20])])
def test_a_hole_is_longer_than_ten_steps(step, pieces):
    t = np.concatenate([0.01 * np.arange(40), 0.39 + step + 0.01 * np.arange(20)])
    assert [len(piece.t) for piece in split_at_holes(measured(t, q=t[:, None]))] == pieces


@pytest.mark.parametrize(("n", "kept"), [(15, ["run#1", "run#2"]), (16, ["run#1", "run#2", "run#3"])])
def test_a_piece_of_sixteen_samples_is_kept(n, kept):
    t = np.concatenate([0.01 * np.arange(30), 9.0 + 0.01 * np.arange(n), 20.0 + 0.01 * np.arange(40)])
    pieces = split_at_holes(replace(measured(t, q=t[:, None]), first_row=7))
    assert [piece.name for piece in pieces] == kept
    assert [piece.first_row for piece in pieces] == [7, *([37] if n == 16 else []), 37 + n]
    (note,) = pieces[-1].notes
    assert (note.row, note.from_s, note.to_s, note.source) == (38, 0.01 * 29, 9.0, "run.csv")
    assert f"parted at 2 hole(s) of up to {20.0 - t[29 + n]:.4g} s, {len(kept)} piece(s) kept" in note.text


def test_a_single_sample_and_nothing_but_short_pieces_have_no_holes():
    alone = measured([3.0], q=np.zeros((1, 1)))
    assert split_at_holes(alone) == [alone]
    t = np.concatenate([0.01 * np.arange(10), 0.2 + 0.01 * np.arange(10)])
    short = measured(t, q=t[:, None])
    assert split_at_holes(short) == [short]


STEP = 0.0123456789  # of no few decimals


@pytest.mark.parametrize(("share", "uniform"), [(0.0, True), (0.0049, True), (-0.0049, True), (0.0051, False)])
def test_a_stamp_may_be_a_two_hundredth_of_a_step_off(share, uniform):
    t = 5.0 + STEP * np.arange(300)
    t[100] += share * STEP
    assert time_step(t)[1] == uniform


@pytest.mark.parametrize(
    ("step", "decimals", "uniform"),
    [
        (0.0123456789, 3, True),
        (0.0021, 3, True),
        (0.0019, 3, False),  # half a step and more: what the step is, nobody can say
        (3.3e-7, 7, True),
        (3.3e-8, 8, False),  # nobody rounds to that
        (3.3, 0, True),
    ],
)
def test_stamps_may_have_been_rounded_to_some_decimals(step, decimals, uniform):
    assert time_step(np.round(step * np.arange(500), decimals))[1] == uniform


@pytest.mark.parametrize(
    ("step", "rounded"), [(0.001 * (1 + 4e-6), 0.001), (0.001 * (1 + 6e-6), 0.00100001), (1 / 3, 0.333333)]
)
def test_a_grid_s_step_is_rounded_by_a_two_hundredth_of_it_in_all(step, rounded):
    assert time_step(step * np.arange(1000)) == (rounded, True)


@pytest.mark.parametrize(("step", "rounded"), [(0.0020019, 0.002), (0.0020021, 0.002002), (0.0019, 0.0019)])
def test_a_median_step_is_rounded_by_a_thousandth(step, rounded):
    steps = np.repeat([0.5 * step, step, 1.7 * step], [20, 100, 30])
    assert time_step(np.concatenate([[0.0], np.cumsum(steps)])) == (rounded, False)


@pytest.mark.parametrize(("n", "enough"), [(15, False), (16, True)])
def test_sixteen_samples_are_enough(n, enough):
    few = measured(0.01 * np.arange(n), q=np.zeros((n, 1)))
    if enough:
        assert len(resample(few).measured.t) == 16
    else:
        with pytest.raises(DataError, match="has 15 samples, expected at least 16"):
            resample(few)


@pytest.mark.parametrize(("rate_hz", "n"), [(5.0, 16), (4.8, 15), (20.0, 63), (1000.0, 3101)])
def test_a_grid_has_every_instant_up_to_the_last_stamp(rate_hz, n):
    motion = measured(0.1 * np.arange(32), q=np.zeros((32, 1)))
    if n < 16:
        with pytest.raises(DataError, match=rf"has {n} samples at {rate_hz:g} Hz, expected at least 16"):
            resample(motion, rate_hz)
    else:
        uniform = resample(motion, rate_hz)
        np.testing.assert_allclose(uniform.measured.t, np.arange(n) / rate_hz, atol=1e-12)
        assert uniform.measured.notes[0].text == f"steps of 100 to 100 ms resampled to {1e3 / rate_hz:.6g} ms"


@pytest.mark.parametrize("rate_hz", [0.0, -3.0, np.nan])
def test_a_rate_is_above_zero_and_at_most_a_hundredfold(rate_hz):
    motion = measured(0.1 * np.arange(32), q=np.zeros((32, 1)))
    with pytest.raises(ConfigError, match="expected a number above 0"):
        resample(motion, rate_hz)
    with pytest.raises(ConfigError, match="rate_hz is 1010, but"):
        resample(motion, 1010.0)
    assert resample(motion, 999.0).dt_s == 1.0 / 999.0


@pytest.mark.parametrize(("off", "kept"), [(0.9e-6, True), (-0.9e-6, True), (1.2e-6, False), (-1.2e-6, False)])
def test_a_rate_that_is_the_samples_own_to_a_millionth_keeps_them(off, kept):
    q = np.random.default_rng(0).normal(size=(50, 1))
    uniform = resample(measured(3.0 + 0.01 * np.arange(50), q=q), 100.0 * (1.0 + off))
    assert (uniform.measured.columns["q"] is q) == kept
    assert (uniform.dt_s == 0.01) == kept and uniform.began_s == 3.0


@pytest.mark.parametrize(("closest", "curve"), [(0.21, CubicSpline), (0.19, PchipInterpolator)])
def test_columns_are_drawn_through_by_the_curve_that_suits_them(closest, curve):
    t = 0.01 * np.arange(60)
    t[30] = t[29] + 0.01 * closest
    q, tau = np.random.default_rng(1).normal(size=(2, 60, 2))
    uniform = resample(measured(t, q=q, tau=tau), rate_hz=90.0).measured
    np.testing.assert_allclose(uniform.columns["q"], curve(t, q)(uniform.t), atol=1e-9)
    np.testing.assert_allclose(uniform.columns["tau"], PchipInterpolator(t, tau)(uniform.t), atol=1e-9)


@pytest.mark.parametrize(("rate_hz", "filtered"), [(67.5, False), (66.0, True), (20.0, True)])
def test_from_one_and_a_half_steps_on_what_a_rate_cannot_carry_is_taken_out(rate_hz, filtered):
    t = 0.01 * np.arange(400)
    q = np.random.default_rng(2).normal(size=(400, 1))
    marked = (np.arange(400) >= 200).astype(float)[:, None]
    uniform = resample(measured(t, q=q, contradicted=marked), rate_hz).measured
    seen = lowpass(q, 0.01, 0.4 * rate_hz) if filtered else q
    np.testing.assert_allclose(uniform.columns["q"], CubicSpline(t, seen)(uniform.t), atol=1e-9)
    straight = np.interp(uniform.t, t, marked[:, 0])
    np.testing.assert_allclose(uniform.columns["contradicted"][:, 0], straight, atol=1e-9)
