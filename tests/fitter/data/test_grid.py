"""The grid of a long motion."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline, PchipInterpolator

from fitter.data.derivatives import lowpass
from fitter.data.grid import grid_of
from fitter.data.motions import Measured
from fitter.data.windows import forgetting_samples
from limbcal.errors import DataError
from limbcal.note import Note


def rows(t):
    return Measured("run", "run.csv", 0, t, {"q": np.sin(3.0 * t)[:, None]})


def test_samples_on_a_grid_stay_as_they_are():
    t = 7.0 + 2e-3 * np.arange(500)
    grid = grid_of(t, None)
    laid, counted = grid.lay(rows(t), slice(100, 400))
    assert grid.as_measured
    assert counted == slice(100, 400)
    assert np.array_equal(laid.columns["q"], rows(t).columns["q"])
    assert np.allclose(laid.t, t - 7.0)
    assert grid_of(t, 500.0).as_measured


@given(st.integers(150, 850), st.integers(0, 99), st.sampled_from([300.0, 777.0, 2100.0]))
def test_neighbours_count_every_instant_once(cut, seed, rate_hz):
    t = 1e-3 * (np.arange(1000) + np.random.default_rng(seed).uniform(-0.3, 0.3, 1000))
    grid = grid_of(t, rate_hz)
    left, counts_left = grid.lay(rows(t[: cut + 100]), slice(0, cut))
    right, counts_right = grid.lay(rows(t[cut - 100 :]), slice(100, len(t) - cut + 100))
    values = np.concatenate([left.columns["q"][counts_left], right.columns["q"][counts_right]])[:, 0]
    instants = t[0] + np.arange(len(values)) / rate_hz
    assert len(values) == int((t[-1] - t[0]) * rate_hz + 1e-6) + 1
    inside = slice(60, -60)
    assert np.allclose(values[inside], np.sin(3.0 * instants[inside]), atol=1e-5)


def test_rows_suffice_for_the_samples_asked_for():
    t = 1e-3 * np.arange(1000)
    for rate_hz in (None, 300.0, 2100.0):
        grid = grid_of(t, rate_hz)
        assert grid.rows(50) * 1e-3 >= 50 * grid.step_s
        assert grid.rows(50) < 1000  # and are no more than a few
        assert grid.rows(51) >= grid.rows(50)


def test_another_rate_or_uneven_stamps_are_no_grid_of_their_own():
    t = 1e-3 * np.arange(1000)
    uneven = t + 1e-4 * np.random.default_rng(0).normal(size=1000)
    assert grid_of(t, None).as_measured and grid_of(t, 1000.0).as_measured
    assert not grid_of(t, 300.0).as_measured and not grid_of(uneven, None).as_measured
    assert grid_of(t, 300.0).step_s == 1.0 / 300.0


def test_stamps_that_leave_the_grid_are_said():
    grid = grid_of(1e-3 * np.arange(100), None)
    with pytest.raises(DataError, match="in rows 1 to 50 stamps are off"):
        grid.lay(rows(1.1e-3 * np.arange(50)), slice(0, 50))


def test_rows_for_a_span_of_samples():
    """64 more for the curve through them; half as many again where stamps may crowd."""
    t = 1e-3 * np.arange(500)
    assert grid_of(t, None).rows(100) == 164
    assert grid_of(t, 800.0).rows(100) == 284  # 1.5 (125 + 64)
    assert grid_of(t, 2000.0).rows(100) == 171  # 1.5 (50 + 64)
    seen = forgetting_samples(1e-3, 200.0)
    assert grid_of(t, 500.0).rows(100) == np.ceil(1.5 * (200 + 64 + seen))
    assert grid_of(t, 670.0).rows(670) == np.ceil(1.5 * (1000 + 64))  # not thinned yet


@pytest.mark.parametrize(("rate_hz", "as_measured"), [(1000.0009, True), (999.9991, True), (1000.0012, False)])
def test_a_grid_is_the_samples_own_to_a_millionth(rate_hz, as_measured):
    grid = grid_of(5.0 + 1e-3 * np.arange(500), rate_hz)
    assert grid.as_measured == as_measured and grid.t0 == 5.0 and grid.own_step_s == 1e-3
    assert grid.step_s == (1e-3 if as_measured else 1.0 / rate_hz)


@pytest.mark.parametrize(("off", "fits"), [(0.9e-3, True), (-0.9e-3, True), (1.2e-3, False), (-1.2e-3, False)])
def test_a_clock_may_drift_by_a_thousandth(off, fits):
    grid = grid_of(1e-3 * np.arange(100), None)
    drifted = replace(rows(1e-3 * (1.0 + off) * np.arange(50)), first_row=30)
    if fits:
        np.testing.assert_allclose(grid.lay(drifted, slice(0, 50))[0].t, 1e-3 * np.arange(50))
    else:
        with pytest.raises(DataError, match=r"'run' had a sample every 0.001 s, but in rows 31 to 80 stamps"):
            grid.lay(drifted, slice(0, 50))


@pytest.mark.parametrize(
    ("counted", "laid"),
    [(slice(10, 30), slice(20, 60)), (slice(0, 40), slice(0, 79)), (slice(39, 40), slice(78, 79))],
)
def test_an_instant_counts_with_the_row_before_it(counted, laid):
    """Rows of a tenth of a second from 2.0 to 5.9 s, laid by twentieths."""
    t = 10.0 + 0.1 * np.arange(100)
    note = Note("unit", "degrees")
    motion = replace(rows(t).rows(20, 60, "part", note), labels=np.full(40, "a"))
    found, slice_found = grid_of(t, 20.0).lay(motion, counted)
    assert slice_found == laid
    np.testing.assert_allclose(found.t, 0.05 * np.arange(79))
    np.testing.assert_allclose(found.columns["q"][::2], motion.columns["q"], atol=1e-9)
    assert found.labels is None and found.notes[0] == note and found.notes[1].text == "resampled to 50 ms"


def test_what_a_lower_rate_cannot_carry_is_taken_out():
    t = 1e-3 * np.arange(2000)
    q, on = np.random.default_rng(3).normal(size=(2000, 1)), (t[:, None] > 1.0).astype(float)
    motion = Measured("run", "run.csv", 0, t, {"q": q, "on": on})
    found, _ = grid_of(t, 400.0).lay(motion, slice(0, 2000))
    seen = CubicSpline(t, lowpass(q, 1e-3, 160.0))(found.t)
    np.testing.assert_allclose(found.columns["q"], seen, atol=1e-9)
    assert set(np.unique(found.columns["on"])) == {0.0, 1.0}
    unfiltered, _ = grid_of(t, 670.0).lay(motion, slice(0, 2000))
    np.testing.assert_allclose(unfiltered.columns["q"], CubicSpline(t, q)(unfiltered.t), atol=1e-9)


@pytest.mark.parametrize(("closest", "curve"), [(0.21, CubicSpline), (0.19, PchipInterpolator)])
def test_crowded_rows_are_drawn_through_without_swinging_out(closest, curve):
    t = 0.01 * np.arange(60)
    t[30] = t[29] + 0.01 * closest
    q = np.random.default_rng(1).normal(size=(60, 2))
    found, _ = grid_of(t, 90.0).lay(Measured("run", "run.csv", 0, t, {"q": q}), slice(0, 60))
    np.testing.assert_allclose(found.columns["q"], curve(t, q)(found.t), atol=1e-9)
