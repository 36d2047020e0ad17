"""The compiled steps are filterpy's own, to rounding."""

import numpy as np
import pytest
from filterpy.kalman import ExtendedKalmanFilter
from hypothesis import given
from hypothesis import strategies as st

from tracking.kalman.extended_kalman import CompiledKalmanFilter


def both(seed: int, size: int, readings: int) -> tuple[np.random.Generator, list[ExtendedKalmanFilter]]:
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((size, size))
    F, Q = np.eye(size) + 0.1 * rng.standard_normal((size, size)), np.diag(rng.uniform(0.1, 1.0, size))
    x = rng.standard_normal(size)
    filters = []
    for kind in (CompiledKalmanFilter, ExtendedKalmanFilter):
        kf = kind(dim_x=size, dim_z=readings)
        kf.x, kf.P, kf.F, kf.Q, kf.B = x.copy(), root @ root.T + np.eye(size), F, Q, np.eye(size)
        filters.append(kf)
    return rng, filters


@given(st.integers(0, 10_000), st.integers(1, 8), st.integers(1, 6))
def test_a_step_is_filterpys(seed: int, size: int, readings: int) -> None:
    rng, (ours, theirs) = both(seed, size, readings)
    shift = rng.standard_normal(size)
    ours.predict(shift)
    theirs.predict(shift)
    np.testing.assert_allclose(ours.x, theirs.x, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(ours.P, theirs.P, rtol=1e-10, atol=1e-10)
    H, at = rng.standard_normal((readings, size)), rng.standard_normal(size)
    z, predicted, R = (
        rng.standard_normal(readings),
        rng.standard_normal(readings),
        np.diag(rng.uniform(0.1, 1.0, readings)),
    )
    squared = ours.correct(z, H, predicted, at, R)
    theirs.update(z, lambda x: H, lambda x: predicted + H @ (x - at), R=R)
    np.testing.assert_allclose(ours.x, theirs.x, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(ours.P, theirs.P, rtol=1e-7, atol=1e-7)
    assert squared == pytest.approx(theirs.y @ theirs.SI @ theirs.y, rel=1e-7)


def test_without_a_shift_it_goes_on_by_itself() -> None:
    _, (ours, theirs) = both(1, 4, 2)
    ours.predict()
    theirs.predict(np.zeros(4))
    np.testing.assert_allclose(ours.x, theirs.x)


def test_readings_that_tell_nothing_have_no_covariance() -> None:
    _, (ours, _) = both(2, 3, 2)
    with pytest.raises(np.linalg.LinAlgError):
        ours.correct(np.zeros(2), np.zeros((2, 3)), np.zeros(2), np.zeros(3), np.zeros((2, 2)))
