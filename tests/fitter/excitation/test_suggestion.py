"""Suggested references tell more than random ones, within the limits."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import Bench
from arm.model import Control
from fitter.excitation.suggestion import suggest
from limbcal.errors import ConfigError, NotConverged

ARM = load_arm("dd-arm")
#: Its reference is its motion, so nothing has to be simulated.
MEASURED = replace(ARM, control=Control())
BENCH = replace(Bench(), rate_hz=200.0, trial_s=3.5, learning=1, evaluating=0)
SMALL = {"seed": 0, "population": 16, "generations": 6}


def worst(found, precision):
    known = found.values != 0.0
    return np.max(precision.std[known] / np.abs(found.values[known]))


@pytest.mark.parametrize(("kind", "name"), [("points", "dd-arm"), ("fourier", "dd-arm-vertical")])
def test_better_than_random_and_within_the_limits(kind, name):
    seen = []
    found = suggest(load_arm(name), kind, BENCH, **SMALL, progress=lambda: seen.append(1))
    assert len(seen) == 6
    assert worst(found, found.suggested) < worst(found, found.random)
    assert found.limits.excess(found.reached) <= 0.0
    assert len(found.motions) == 1
    assert len(found.motions[0].t) == 700


def test_same_seed_same_motion_another_seed_another():
    first, again, other = (
        suggest(MEASURED, "points", BENCH, **(SMALL | {"seed": seed, "generations": 2})) for seed in (0, 0, 1)
    )
    assert np.array_equal(first.motions[0].ref, again.motions[0].ref)
    assert not np.array_equal(first.motions[0].ref, other.motions[0].ref)


def test_trials_go_on_where_the_last_one_ended():
    found = suggest(MEASURED, "points", replace(BENCH, learning=3), **(SMALL | {"generations": 2}))
    for before, after in zip(found.motions[:-1], found.motions[1:], strict=True):
        assert np.allclose(after.ref[0], before.ref[-1])
        assert np.allclose(after.dq[0], 0.0)


def test_what_is_wanted_is_revealed_better():
    name = "m2*sy2"
    more = SMALL | {"generations": 15}
    everything, one = (suggest(MEASURED, "points", BENCH, **more, reveal=reveal) for reveal in ([], [name]))
    k = one.base.names.index(name)
    assert one.suggested.std[k] < everything.suggested.std[k]


def test_limits_that_are_given_are_kept():
    limits = {"angle": np.array([0.5, 0.4]), "speed": np.array([0.4, 0.5]), "torque": np.array([3.0, 2.0])}
    found = suggest(MEASURED, "fourier", BENCH, **SMALL, **limits)
    for name, most in limits.items():
        assert np.all(getattr(found.reached, name) <= most)


def test_with_measured_torque_the_reference_is_the_motion():
    for kind in ("fourier", "points"):
        found = suggest(MEASURED, kind, BENCH, **(SMALL | {"generations": 12}))
        motion = found.motions[0]
        assert np.array_equal(motion.q, motion.ref)
        assert np.allclose(np.gradient(motion.q, 0.005, axis=0), motion.dq, atol=0.02 * np.abs(motion.dq).max())
        assert worst(found, found.suggested) < worst(found, found.random)


def test_says_what_is_wrong():
    with pytest.raises(ConfigError, match="no base parameter is called m9"):
        suggest(ARM, "points", BENCH, **SMALL, reveal=["m9"])
    with pytest.raises(ConfigError, match="no time to move"):
        suggest(ARM, "points", replace(BENCH, trial_s=0.9), **SMALL)
    hanging = load_arm("dd-arm-vertical")  # rests far from zero
    few = SMALL | {"generations": 1}
    with pytest.raises(NotConverged, match="joint 1 reaches angle 1.2"):
        suggest(hanging, "points", BENCH, **few, angle=np.full(2, 0.1))
