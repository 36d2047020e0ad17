"""What the benchmark does to readings: nothing at size 0, and what it says elsewhere."""

import numpy as np
import pytest

from arm.arm_file import load_arm
from benchmarks.discrepancies import (
    EFFECTS,
    SHAKING_S,
    felt,
    of_exact_filter,
    of_filter,
    read,
    shaking_base,
    swing,
)

ARM = load_arm("dd-arm-vertical")
MOTION = swing(np.random.default_rng(0))


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_of_no_size_is_none(name: str) -> None:
    make = EFFECTS[name][0]
    np.testing.assert_allclose(make(ARM, MOTION, 0.0, np.random.default_rng(1)), felt(ARM, MOTION), atol=1e-12)


def test_speeds_and_accelerations_are_those_of_the_angles() -> None:
    """Over two steps by Simpson's rule; differences over whole steps were off by 0.7 and 8 % of one of them."""
    t, q, dq, ddq = MOTION
    h = t[1] - t[0]
    for values, slopes in ((q, dq), (dq, ddq)):
        gone = (slopes[:-2] + 4.0 * slopes[1:-1] + slopes[2:]) * h / 3.0
        assert np.abs(values[2:] - values[:-2] - gone).max() < 1e-3 * np.abs(slopes).max() * h


@pytest.mark.parametrize("name", ["late sensor", "flex", "play"])
def test_only_the_last_sensor_is_loose_bent_or_late(name: str) -> None:
    make, sizes, _ = EFFECTS[name]
    more = make(ARM, MOTION, sizes[2], np.random.default_rng(1)) - felt(ARM, MOTION)
    assert not more[:, :9].any() and np.abs(more[:, 9:]).max() > 0.05


def test_a_base_shakes_all_sensors_alike() -> None:
    """As strongly in whatever axes, and for as long as it says."""
    more = shaking_base(ARM, MOTION, 1.0, np.random.default_rng(2)) - felt(ARM, MOTION)
    size = np.linalg.norm(more.reshape(len(more), 4, 3), axis=2)
    np.testing.assert_allclose(size, np.tile(size[:, :1], 4), rtol=1e-9)
    assert np.sqrt(np.mean(more**2)) == pytest.approx(1.0, rel=0.3)
    z = more[:, 2]  # the joints' axes: nothing turns it
    lag = round(SHAKING_S / (MOTION.t[1] - MOTION.t[0]))
    assert np.corrcoef(z[lag:], z[:-lag])[0, 1] == pytest.approx(np.exp(-1.0), abs=0.25)


def test_the_live_filter_holds_what_it_claims_where_a_base_shakes() -> None:
    """And errs by half of what one does that takes the base to stand, at the most."""
    rng = np.random.default_rng(3)
    readings = read(shaking_base(ARM, MOTION, 0.3, rng), rng)
    exact, found = of_exact_filter(ARM, readings, MOTION.q), of_filter(ARM, readings, MOTION.q)
    assert found[0] < 0.5 * exact[0]
    assert found[1] > 0.95 > exact[1]
