"""Sines and cosines against numpy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.sine_cosine import sines_cosines

EPS = np.finfo(float).eps


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-3.0, 7.0))
def test_they_are_right_to_the_last_bit_but_one(seed, decade):
    angles = np.random.default_rng(seed).uniform(-(10.0**decade), 10.0**decade, (100, 2))
    sine, cosine = sines_cosines(angles)
    np.testing.assert_allclose(sine, np.sin(angles), rtol=0, atol=2.0 * EPS)
    np.testing.assert_allclose(cosine, np.cos(angles), rtol=0, atol=2.0 * EPS)


def test_at_every_eighth_of_a_turn_they_are_in_the_right_quarter():
    angles = np.arange(-33, 34) * np.pi / 4.0
    sine, cosine = sines_cosines(angles)
    np.testing.assert_allclose(sine + 1j * cosine, np.sin(angles) + 1j * np.cos(angles), rtol=0, atol=2.0 * EPS)


@pytest.mark.parametrize("odd", [np.nan, np.inf, -np.inf])
def test_what_is_no_angle_has_neither(odd):
    with np.errstate(invalid="ignore"):
        sine, cosine = sines_cosines(np.array([0.0, odd]))
    assert np.isnan([sine[1], cosine[1]]).all() and (sine[0], cosine[0]) == (0.0, 1.0)
