"""The virtual arm plays the bench, goes over into rest without a jerk, and repeats itself."""

from itertools import islice

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.bench import COUNT_M_S2, Bench, motions
from daemon.virtual_motion import BenchPlan, Stretch, stretches, truth_stride

RATE_HZ = 2000.0


def plan(trials: int = 2, noise: float = 0.0, seed: int = 4) -> BenchPlan:
    return BenchPlan(load_arm("dd-arm"), seed, RATE_HZ, trials, noise)


def first(n: int, which: BenchPlan) -> list[Stretch]:
    return list(islice(stretches(which), n))


def test_the_trials_are_the_benchs() -> None:
    played = first(2, plan())
    bench = islice(motions(load_arm("dd-arm"), Bench(rate_hz=RATE_HZ), 4), 2)
    for number, (stretch, motion) in enumerate(zip(played, bench, strict=True), start=1):
        assert stretch.trial == number
        assert len(stretch.counts) == 13500
        np.testing.assert_array_equal(stretch.truth["q2"], motion.q[:: truth_stride(RATE_HZ), 1])


def test_motion_goes_on_from_stretch_to_stretch() -> None:
    played = first(5, plan())
    assert [stretch.trial for stretch in played] == [1, 2, 0, 0, 0]
    truth = {name: np.concatenate([s.truth[name] for s in played]) for name in played[0].truth}
    np.testing.assert_allclose(np.diff(truth["t"]), truth_stride(RATE_HZ) / RATE_HZ, rtol=1e-9)
    for joint in (1, 2):
        step = np.diff(truth[f"q{joint}"])
        mean_speed = 0.5 * (truth[f"dq{joint}"][1:] + truth[f"dq{joint}"][:-1])
        assert np.abs(step - mean_speed * truth_stride(RATE_HZ) / RATE_HZ).max() < 2e-5
    held = np.concatenate([s.counts for s in played[3:]]) * COUNT_M_S2
    assert np.abs(held[:, 2::3] - 9.80665).max() < 2 * COUNT_M_S2
    assert np.abs(held[:, 0::3]).max() < 0.01


def test_the_same_plan_gives_the_same_samples_and_another_seed_others() -> None:
    one, same, other = (first(2, plan(1, 1.0, seed)) for seed in (4, 4, 5))
    np.testing.assert_array_equal(one[1].counts, same[1].counts)
    assert np.any(one[0].counts != other[0].counts)


@pytest.mark.parametrize("noise", [0.0, 1.0, 3.0])
def test_noise_is_what_was_asked_for(noise: float) -> None:
    resting = first(1, plan(0, noise))[0].counts * COUNT_M_S2
    found = resting.std(axis=0)
    assert np.all(np.abs(found - 0.02 * noise) < 0.1 * 0.02 * noise + COUNT_M_S2)


def test_no_trials_is_rest_at_zero() -> None:
    (stretch,) = first(1, plan(0))
    assert stretch.trial == 0
    assert not stretch.truth["q1"].any()
