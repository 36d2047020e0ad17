"""The virtual arm's samples, computed ahead by a process of its own."""

from collections.abc import Iterator
from itertools import islice

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.model import Control
from daemon.virtual_device.motion_source import MotionSource
from daemon.virtual_device.virtual_motion import BenchPlan, stretches
from limbcal.errors import ConfigError, DeviceError
from tests.daemon.conftest import wait_until
from tests.patience import PATIENCE_S

RATE_HZ = 500.0
PLAN = BenchPlan(load_arm("dd-arm"), 4, RATE_HZ, trials=2)
N_TRIAL = round(6.75 * RATE_HZ)


@pytest.fixture
def source() -> Iterator[MotionSource]:
    made = MotionSource(PLAN, keep_truth=True)
    yield made
    made.close()


def fetched(source: MotionSource, n_sample: int) -> np.ndarray:
    """Return the next samples, as soon as they are there."""
    while True:
        taken = source.take(n_sample)
        if taken is not None:
            return taken
        assert source.wait(PATIENCE_S)
        source.fetch()


def test_samples_are_the_plan_s_in_any_portion(source: MotionSource) -> None:
    assert source.truth() == {}
    trials = list(islice(stretches(PLAN), 2))
    portions = [1, 124, 125, 126, 32, 1000, N_TRIAL - 1000, 17]
    got = [fetched(source, n) for n in portions]
    assert [len(one) for one in got] == portions
    expected = np.concatenate([one.counts for one in trials])
    taken = sum(portions)
    np.testing.assert_array_equal(np.concatenate(got), expected[:taken])
    assert source.taken == taken > N_TRIAL
    truth = source.truth()
    assert len(truth["t"]) == taken and truth["t"][-1] == pytest.approx((taken - 1) / RATE_HZ)
    last = truth["trial"].tolist()
    assert last == [1.0] * N_TRIAL + [2.0] * (taken - N_TRIAL)
    np.testing.assert_array_equal(truth["q1"][:N_TRIAL], trials[0].truth["q1"])


def test_two_trials_are_held_and_what_is_not_there_is_not_taken(source: MotionSource) -> None:
    assert source.take(1) is None and source.taken == 0
    assert source.wait(PATIENCE_S)
    source.fetch()
    assert source.wait(0.0)
    assert source.take(126) is None  # a quarter of a second came
    first = source.take(125)
    assert first is not None and len(first) == source.taken == 125
    most = round(13.5 * RATE_HZ)
    for _ in range(54):  # quarters of a second
        wait_until(source._receiver.poll, "more came")
        source.fetch()
    assert source.take(most + 1) is None
    wait_until(source._receiver.poll, "more came")
    source.fetch()  # as many as are held are not too many
    source.fetch()
    source.fetch()
    assert source.take(most + 200) is None
    assert source.take(most + 125) is not None
    source._process.kill()
    with pytest.raises(DeviceError, match="the process that computes the virtual arm's motion ended by itself"):
        for _ in range(10_000):
            fetched(source, 10)


def test_without_truth_none_is_kept() -> None:
    source = MotionSource(PLAN, keep_truth=False)
    try:
        fetched(source, 200)
        assert source.truth() == {}
    finally:
        source.close()


def test_a_plan_that_cannot_be_computed_says_why() -> None:
    lawless = BenchPlan(load_arm("dd-arm").__class__("x", PLAN.arm.joints, control=Control()), 0, RATE_HZ, 1)
    source = MotionSource(lawless, keep_truth=False)
    try:
        with pytest.raises(ConfigError, match="control"):
            fetched(source, 1)
    finally:
        source.close()
