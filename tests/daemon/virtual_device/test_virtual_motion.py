"""The virtual arm plays the bench, goes over into rest without a jerk, and repeats itself."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm
from arm.bench import Bench, motions, rest_angles
from arm.counts import COUNT_M_S2
from arm.highpass import HighPass
from daemon.virtual_device.virtual_motion import BenchPlan, Stretch, stretches, truth_stride

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


def test_ac_coupled_sensors_forget_gravity_and_know_the_motions_before() -> None:
    arm = load_arm("dd-arm")
    coupled = replace(plan(), highpass_hz=0.2)
    played = first(3, coupled)
    found = np.concatenate([stretch.counts for stretch in played]) * COUNT_M_S2
    assert np.abs(found[:, 2::3]).max() == 0.0
    bench = list(islice(motions(arm, Bench(rate_hz=RATE_HZ), 4), 2))
    moved = (np.concatenate([getattr(motion, name) for motion in bench]) for name in ("q", "dq", "ddq"))
    force = specific_force(arm, *moved).reshape(-1, 12)
    HighPass(np.full(12, 0.2), RATE_HZ).apply(force)
    np.testing.assert_allclose(found[: len(force)], force, rtol=0, atol=0.51 * COUNT_M_S2)
    held = replace(arm, sensors=tuple(replace(sensor, highpass_hz=0.2) for sensor in arm.sensors))
    of_the_file = first(3, replace(plan(), arm=held))
    for one, other in zip(played, of_the_file, strict=True):
        np.testing.assert_array_equal(one.counts, other.counts)
    (dc,) = first(1, replace(plan(), arm=held, highpass_hz=0.0))
    np.testing.assert_array_equal(dc.counts, first(1, plan())[0].counts)


def test_without_trials_an_arm_with_weight_rests_where_it_hangs() -> None:
    arm = load_arm("spatial-arm")
    one, two = first(2, replace(plan(0), arm=arm))
    q = rest_angles(arm, np.zeros(3))
    assert q[1] < -0.02
    for j in range(3):
        held = np.concatenate([one.truth[f"q{j + 1}"], two.truth[f"q{j + 1}"]])
        np.testing.assert_allclose(held, q[j], rtol=0, atol=1e-9)


def test_the_truth_of_a_rest_has_a_row_a_millisecond() -> None:
    rested = first(2, plan(0))
    assert [len(stretch.counts) for stretch in rested] == [2 * 2000, 2 * 2000]
    assert np.diff(np.concatenate([stretch.truth["t"] for stretch in rested])) == pytest.approx(0.001)
    assert [truth_stride(rate_hz) for rate_hz in (100.0, 1000.0, 1499.0, 1501.0, 32000.0)] == [1, 1, 1, 2, 32]


@pytest.mark.parametrize("rate_hz", [2500.0, 3500.0, 300.0])
def test_rows_of_the_truth_are_evenly_apart_across_stretches(rate_hz: float) -> None:
    """Also where a stretch has no whole number of them: every second of 16875 samples, every fourth of 23625."""
    played = first(3, replace(plan(1), rate_hz=rate_hz))
    n = [len(stretch.counts) for stretch in played]
    assert n == [round(6.75 * rate_hz), round(2.0 * rate_hz), round(2.0 * rate_hz)]
    t = np.concatenate([stretch.truth["t"] for stretch in played])
    np.testing.assert_allclose(t, np.arange(0, sum(n), truth_stride(rate_hz)) / rate_hz, rtol=0, atol=1e-9)
    assert [set(stretch.truth["trial"]) for stretch in played] == [{1.0}, {0.0}, {0.0}]
    assert set(played[0].truth) == {
        *("t", "trial", "q1", "q2", "dq1", "dq2", "ddq1", "ddq2", "ref1", "ref2", "tipx", "tipy", "tipz")
    }
    reach = np.hypot(played[0].truth["tipx"], played[0].truth["tipy"])
    a = [joint.a_m for joint in load_arm("dd-arm").joints]
    expected = np.sqrt(a[0] ** 2 + a[1] ** 2 + 2.0 * a[0] * a[1] * np.cos(played[0].truth["q2"]))
    np.testing.assert_allclose(reach, expected, rtol=0, atol=1e-12)
