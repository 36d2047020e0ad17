"""When a smoothed motion explains its readings, what it leaves of them, and what the next window takes over."""

from types import SimpleNamespace

import numpy as np
import pytest

from arm.model import Floats
from tracking.smoother.smoothed import Smoothed
from tracking.smoother.smoothing_pass import Pass

DT_S, CHANNELS = 0.01, 9
KINDS = (slice(0, 6), slice(6, 9))


def smoothed(error: Floats, precision: float = 1.0, **other: object) -> Smoothed:
    """Return what a smoother says that leaves some errors, (n, n_channel), of two joints with three sensors."""
    n = len(error)
    beside = np.full((n, 2), 1e3)  # of joints at rest: they are no readings
    course = SimpleNamespace(dt=DT_S, noise=np.arange(1.0, 10.0), push=np.ones(2), doubt=np.full((n, 9), 2.0))
    found = Pass(
        np.zeros((n, 15)),
        np.tile(np.arange(8.0), (n, 1)),
        np.hstack([error, beside]),
        np.hstack([np.full((n, CHANNELS), precision), beside]),
    )
    said = {
        **{"states": found.states, "found": found, "along": found.states, "before": np.eye(15)},
        **{
            "final": np.zeros(15),
            "covariance": np.eye(15),
            "still": np.ones(n, bool),
            "resting": np.ones(n, bool),
        },
        **{"doubted": 0.0, "passes": 3, "converged": True, "course": course, "alike": KINDS},
    }
    return Smoothed(**{**said, **other})


def limit(blocks: int, channels: int) -> float:
    """Return 1.21 and four standard deviations of a mean of squares: what noise is known to, and chance."""
    return 1.21 * (1.0 + 4.0 * np.sqrt(2.0 / (blocks * channels)))


@pytest.mark.parametrize("precision", [1.0, 0.3])
@pytest.mark.parametrize(
    ("n", "blocks", "length"),
    [(1000, 40, 25), (1024, 40, 25), (999, 39, 25), (25, 1, 25), (26, 1, 25), (10, 1, 10)],
)
def test_each_kind_of_sensor_is_explained_up_to_chance(n, blocks, length, precision):
    """Errors that do not change add up over a quarter of a second: 25 of them are 25 times as unlikely as one."""
    for kind, channels in zip(KINDS, (6, 3), strict=True):
        for share, expected in ((0.999, True), (1.001, False)):
            error = np.zeros((n, CHANNELS))
            error[:, kind] = np.sqrt(share * limit(blocks, channels) * precision / length)
            error[blocks * length :] = 1e3  # what makes no whole block
            assert smoothed(error, precision).is_exact is expected


def test_errors_that_alternate_add_up_to_nothing():
    error = np.where(np.arange(1000) % 2, 1.0, -1.0)[:, None] * np.ones(CHANNELS)
    assert smoothed(error).is_exact


@pytest.mark.parametrize("other", [{"converged": False}, {"is_near": False}])
def test_what_is_far_or_not_at_its_end_explains_nothing(other):
    assert smoothed(np.zeros((100, CHANNELS))).is_exact
    assert not smoothed(np.zeros((100, CHANNELS)), **other).is_exact


def test_errors_without_a_number_explain_nothing():
    assert not smoothed(np.full((100, CHANNELS), np.nan)).is_exact


def test_residuals_are_errors_by_the_variance_of_the_noise():
    error = np.random.default_rng(0).normal(size=(20, CHANNELS))
    np.testing.assert_allclose(smoothed(error).residual, error * [2, 4, 6, 8, 10, 12, 14, 16, 18])


def test_variances_are_those_of_joints_alone():
    np.testing.assert_array_equal(smoothed(np.zeros((4, CHANNELS))).variance, np.tile(np.arange(6.0), (4, 1)))


@pytest.mark.parametrize(("size", "lasts"), [(17, 17), (20, 15), (15, 15)])
def test_motion_and_offsets_go_on_and_constants_of_the_same_kind(size, lasts):
    """Two joints have six entries and nine channels an offset each; where the states differ no more goes on."""
    known = 17 if size == 17 else 16
    rng = np.random.default_rng(1)
    final, covariance = rng.normal(size=known), rng.normal(size=(known, known))
    x, P = rng.normal(size=size), rng.normal(size=(size, size))
    before_x, before_P = x.copy(), P.copy()
    smoothed(np.zeros((4, CHANNELS)), final=final, covariance=covariance).continued(x, P)
    np.testing.assert_array_equal(x, [*final[:lasts], *before_x[lasts:]])
    np.testing.assert_array_equal(P[:lasts, :lasts], covariance[:lasts, :lasts])
    np.testing.assert_array_equal(P[lasts:, lasts:], before_P[lasts:, lasts:])
    np.testing.assert_array_equal(P[:lasts, lasts:], 0.0)
    np.testing.assert_array_equal(P[lasts:, :lasts], 0.0)
