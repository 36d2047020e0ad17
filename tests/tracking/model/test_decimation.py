"""From the sensors' rate to the frames': the same however cut, gravity as it is, phases where they belong."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import firwin

from tracking.model.decimation import Decimator

FEW = settings(max_examples=60, deadline=None)
NOISE = np.random.default_rng(4).normal(size=(400, 2))


def decimated(readings, factor):
    decimator = Decimator(factor, readings.shape[1])
    return np.vstack([decimator.push(readings), decimator.flush()])


def tone(cycles_a_frame, factor, n_frame=200, phase=0.4):
    """Return a sine by the sample, and what it is where frames are due."""
    at = np.arange(n_frame * factor) / factor
    due = at[factor // 2 :: factor]
    return tuple(np.sin(2 * np.pi * cycles_a_frame * t + phase)[:, None] for t in (at, due))


@FEW
@given(st.integers(1, 9), st.lists(st.integers(0, 90), max_size=12))
def test_pieces_of_any_size_give_the_same_bytes(factor, sizes):
    decimator = Decimator(factor, 2)
    cuts = np.cumsum(sizes)
    pieces = np.split(NOISE, cuts[cuts < len(NOISE)])
    found = np.vstack([decimator.push(piece) for piece in pieces] + [decimator.flush()])
    assert found.tobytes() == decimated(NOISE, factor).tobytes()


@FEW
@given(st.integers(1, 9), st.integers(1, 90), st.integers(0, 90))
def test_it_knows_how_many_frames_readings_will_complete(factor, before, n):
    decimator = Decimator(factor, 2)
    decimator.push(NOISE[:before])
    assert decimator.completes(n) == len(decimator.push(NOISE[before : before + n]))


@FEW
@given(st.integers(1, 12), st.integers(1, 200))
def test_every_frame_whose_own_sample_came_is_given(factor, n):
    assert len(decimated(NOISE[:n], factor)) == len(range(factor // 2, n, factor))


@pytest.mark.parametrize("factor", [1, 2, 4, 5, 32])
def test_gravity_passes_as_it_is(factor):
    level = np.full((20 * factor, 3), 9.80665)
    np.testing.assert_allclose(decimated(level, factor), 9.80665, rtol=1e-14)


@pytest.mark.parametrize("factor", [2, 4, 5, 32])
def test_a_slow_sine_keeps_its_phase_and_size(factor):
    """At 1 % of the frame rate, which for frames of 1 kHz are 10 Hz."""
    sampled, due = tone(0.01, factor)
    inner = slice(4, -4)
    np.testing.assert_allclose(decimated(sampled, factor)[inner], due[inner], rtol=0, atol=1e-3)


@pytest.mark.parametrize("factor", [4, 5, 32])
def test_what_frames_cannot_hold_is_damped(factor):
    """By more than 40 dB at one and a half times their rate, and no worse further up."""
    for cycles in (1.5, 1.7, 0.45 * factor):
        sampled, _ = tone(cycles, factor)
        assert np.abs(decimated(sampled, factor)[4:-4]).max() < 0.01, cycles


def test_with_one_sample_a_frame_nothing_is_filtered():
    decimator = Decimator(1, 2)
    np.testing.assert_array_equal(decimator.push(NOISE), NOISE)
    assert decimator.delay_samples == 0 and len(decimator.flush()) == 0


@pytest.mark.parametrize("factor", [2, 5, 32])
def test_a_frame_comes_once_its_delay_has_passed(factor):
    decimator = Decimator(factor, 1)
    due = factor // 2 + decimator.delay_samples
    assert len(decimator.push(np.zeros((due, 1)))) == 0
    assert len(decimator.push(np.zeros((1, 1)))) == 1
    assert len(decimator.push(np.zeros((factor - 1, 1)))) == 0
    assert len(decimator.push(np.zeros((1, 1)))) == 1


@FEW
@given(
    st.integers(1, 9),
    st.lists(st.tuples(st.integers(0, 80), st.integers(0, 60)), min_size=1, max_size=4),
    st.integers(60, 100),
)
def test_frames_are_numbered_as_if_nothing_were_lost(factor, stretches, rest):
    """Each has the number, and away from the edges the value, that it has in the uninterrupted stream."""
    decimator, whole = Decimator(factor, 2), decimated(np.tile(NOISE, (2, 1)), factor)
    samples, at, frames = np.tile(NOISE, (2, 1)), 0, 0
    for there, lost in [*stretches, (rest, 0)]:
        found = np.vstack([decimator.push(samples[at : at + there]), decimator.flush()])
        for k, frame in enumerate(found, start=frames):
            centre = k * factor + factor // 2
            assert at <= centre < at + there
            if at + decimator.delay_samples <= centre < at + there - decimator.delay_samples:
                np.testing.assert_array_equal(frame, whole[k])
        at, frames = at + there + lost, frames + len(found)
        if lost:
            skipped = decimator.skip(lost)
            assert skipped >= 0
            frames += skipped
    assert frames == len(range(factor // 2, at, factor))


def test_a_flush_without_readings_gives_none():
    decimator = Decimator(4, 3)
    assert decimator.flush().shape == (0, 3)
    assert decimator.push(np.empty((0, 3))).shape == (0, 3)
    assert decimator.flush().shape == (0, 3)


@pytest.mark.parametrize(("factor", "half"), [(1, 0), (2, 3), (3, 4), (4, 6), (5, 7)])
def test_its_low_pass_is_scipy_s_behind_a_kaiser_window(factor, half):
    """Three frames long in all, and its corner at nine tenths of what frames can hold."""
    decimator = Decimator(factor, 1)
    assert decimator.delay_samples == half
    taps = firwin(2 * half + 1, 0.9 / factor, window=("kaiser", 5.0)) if half else np.ones(1)
    readings = np.random.default_rng(factor).normal(size=(12 * factor, 1))
    padded = np.concatenate([np.repeat(readings[:1], half), readings[:, 0], np.repeat(readings[-1:], half)])
    expected = np.convolve(padded, taps, mode="valid")[factor // 2 :: factor]
    np.testing.assert_allclose(decimated(readings, factor)[:, 0], expected, rtol=0, atol=1e-12)
