"""The high-pass of AC-coupled sensors: exact for straight pieces, whatever the blocks, settled at the start."""

import numpy as np
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.highpass import HighPass

FEW = settings(max_examples=40, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)
RATE_HZ = 1000.0


def passed(readings, corner_hz, rate_hz=RATE_HZ):
    out = np.array(readings, dtype=float).reshape(len(readings), -1)
    HighPass(np.broadcast_to(corner_hz, out.shape[1:]), rate_hz).apply(out)
    return out


@FEW
@given(SEEDS, st.floats(1e-3, 3.0 * RATE_HZ))
def test_it_is_the_exact_solution_for_readings_that_run_straight_from_sample_to_sample(seed, corner_hz):
    """Scipy solves the same equation, in state space, by the exponential of a matrix."""
    readings = 30.0 + np.cumsum(np.random.default_rng(seed).normal(size=200))
    wc = 2.0 * np.pi * corner_hz
    t = np.arange(200) / RATE_HZ
    _, expected, _ = scipy.signal.lsim((-wc, wc, -1.0, 1.0), readings, t, X0=readings[:1])
    np.testing.assert_allclose(passed(readings, corner_hz)[:, 0], expected, rtol=0, atol=1e-9)


@FEW
@given(SEEDS, st.lists(st.integers(0, 100), max_size=6))
def test_it_does_not_matter_how_the_blocks_are_cut(seed, cuts):
    rng = np.random.default_rng(seed)
    readings, corner_hz = rng.normal(size=(100, 4)), np.array([0.0, *rng.uniform(0.01, 500.0, 3)])
    one = HighPass(corner_hz, RATE_HZ)
    blocks = [block.copy() for block in np.split(readings, sorted(cuts))]
    for block in blocks:
        one.apply(block)
    np.testing.assert_array_equal(np.concatenate(blocks), passed(readings, corner_hz))


@FEW
@given(SEEDS, st.floats(1e-6, 1e6))
def test_what_has_always_been_there_is_forgotten_from_the_first_sample_on(seed, corner_hz):
    constant = np.random.default_rng(seed).uniform(-50.0, 50.0, 3)
    np.testing.assert_array_equal(passed(np.tile(constant, (50, 1)), corner_hz), 0.0)


@FEW
@given(SEEDS)
def test_a_corner_of_zero_leaves_the_reading_as_it_is_and_each_channel_has_its_own(seed):
    readings = np.random.default_rng(seed).normal(size=(30, 3))
    found = passed(readings, [0.0, 5.0, 0.0])
    np.testing.assert_array_equal(found[:, [0, 2]], readings[:, [0, 2]])
    np.testing.assert_array_equal(found[:, 1], passed(readings[:, 1], 5.0)[:, 0])


@pytest.mark.parametrize(("hz", "gain", "lead_deg"), [(0.2, 0.1 / np.hypot(1, 0.1), 84.29), (2.0, 0.5**0.5, 45.0)])
def test_a_sine_passes_by_the_gain_of_first_order_and_leads(hz, gain, lead_deg):
    t = np.arange(20_000) / RATE_HZ
    found = passed(np.sin(2 * np.pi * hz * t), 2.0)[-10_000:, 0]  # whole periods, long after the start
    basis = np.column_stack([np.sin(2 * np.pi * hz * t), np.cos(2 * np.pi * hz * t)])[-10_000:]
    (along, across), *_ = np.linalg.lstsq(basis, found)
    assert np.hypot(along, across) == pytest.approx(gain, rel=1e-4)
    assert np.rad2deg(np.arctan2(across, along)) == pytest.approx(lead_deg, abs=0.02)


def test_a_jump_fades_by_e_in_the_time_constant():
    wc = 2.0 * np.pi * 0.5
    later = round(RATE_HZ / wc)
    found = passed([0.0, *[10.0] * (later + 1)], 0.5)[:, 0]
    assert found[1] == pytest.approx(10.0, rel=2e-3)  # half a step of the way was forgotten while it rose
    np.testing.assert_allclose(found[1:], found[1] * np.exp(-wc * np.arange(later + 1) / RATE_HZ), rtol=1e-12)
    assert found[-1] == pytest.approx(10.0 / np.e, rel=2e-3)


def test_nothing_is_settled_by_an_empty_block():
    high_pass, block = HighPass(np.array([1.0]), RATE_HZ), np.array([[3.0], [4.0]])
    high_pass.apply(np.empty((0, 1)))
    high_pass.apply(block)
    np.testing.assert_array_equal(block, passed([3.0, 4.0], 1.0))
