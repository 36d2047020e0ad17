"""Shapes of trials: at rest where they should be, and derivatives that belong to their angles."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fitter.excitation.shapes import Fourier, Points

T = np.arange(27000) / 4000.0
SPAN = np.array([1.2, 0.5, 0.3])
BEFORE = np.array([0.3, -0.2, 0.1])


def genes_of(shape, seed):
    return np.random.default_rng(seed).uniform(-1, 1, shape.n_gene)


def belong_together(motion, tolerance):
    dt = T[1]
    for low, high in ((motion[0], motion[1]), (motion[1], motion[2])):
        assert np.allclose(np.gradient(low, dt, axis=0), high, atol=tolerance * np.abs(high).max())


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), size=st.floats(0.1, 1.0))
def test_a_series_begins_and_ends_at_rest(seed, size):
    shape = Fourier(6.75, 0.5, SPAN)
    motion = shape.trial(size * genes_of(shape, seed), T, BEFORE)
    resting = (T <= 0.5) | (T >= 6.25)
    assert not np.any(motion[:, resting])
    inner = np.flatnonzero(~resting)[[0, -1]]
    for derivative in motion:
        assert np.all(np.abs(derivative[inner]) < 1e-2 * np.abs(derivative).max(axis=0))
    assert np.all(np.abs(motion[0]) <= SPAN * (1 + 1e-12))
    belong_together(motion, 5e-3)


def test_a_series_has_all_its_harmonics_and_no_others():
    shape = Fourier(6.75, 0.5, SPAN)
    t = 0.5 + np.arange(1024) / 1024 * 5.75
    spectrum = np.abs(np.fft.rfft(shape.trial(genes_of(shape, 1), t, BEFORE)[0], axis=0))
    assert np.all(spectrum[1:6] > 1e-2)
    assert np.all(spectrum[6:] < 1e-9)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_points_are_reached_one_after_the_other(seed):
    jumping, smooth = (Points(6.75, 0.5, SPAN, smooth) for smooth in (False, True))
    assert jumping.points == 5
    genes = genes_of(jumping, seed)
    goals = np.vstack([BEFORE, genes.reshape(5, 3) * SPAN])
    jumps, moves = (shape.trial(genes, T, BEFORE) for shape in (jumping, smooth))
    assert np.allclose(jumps[0, T < 0.499], BEFORE)
    for k in range(6):
        end = np.searchsorted(T, 0.499 + 1.25 * k)
        assert np.allclose(jumps[0, end], goals[k])
        assert np.allclose(moves[0, end], goals[k])
        assert np.allclose(moves[1:, end], 0.0, atol=1e-6)
    assert not np.any(jumps[1:])
    belong_together(moves, 2e-2)


def test_a_short_trial_has_one_point():
    shape = Points(1.2, 0.5, SPAN, smooth=False)
    assert shape.points == 1
    assert shape.n_gene == 3
