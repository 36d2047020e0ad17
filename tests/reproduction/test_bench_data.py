"""Motions for the paper's experiments."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.bench import Bench, targets
from fitter.data.trial import Trial
from fitter.report.published import PARAMETERS, SAMPLES, TRUE
from reproduction.bench_data import (
    angle_spread,
    bench_trials,
    noisy_trials,
    true_arm,
    true_values,
    under,
    unknown_arm,
)


@pytest.fixture(scope="module")
def trials() -> list[Trial]:
    return bench_trials(true_arm(), 40_000, seed=3, learning=4, evaluating=1)


def test_the_true_arm_has_the_values_that_the_paper_calls_true():
    values = true_values(true_arm())
    assert tuple(values) == PARAMETERS
    np.testing.assert_allclose(list(values.values()), TRUE, atol=5e-7)


def test_of_an_unknown_arm_nothing_is_left_that_a_fit_is_to_find():
    arm, known = true_arm(), unknown_arm(true_arm())
    assert known.sensors == arm.sensors
    assert known.control == arm.control
    assert all(joint.a_m == 0.5 and joint.link.mass_kg == 0.0 for joint in known.joints)
    assert all(joint.friction.viscous_N_m_s == joint.friction.coulomb_N_m == 0.0 for joint in known.joints)


def test_trials_have_the_samples_that_were_asked_for_and_their_roles(trials):
    assert [len(trial.t) for trial in trials] == [10_000] * 5
    assert [trial.role for trial in trials] == ["learn"] * 4 + ["evaluate"]
    assert trials[0].t[-1] + trials[0].dt_s == pytest.approx(Bench.trial_s)
    five = bench_trials(true_arm(), SAMPLES)
    assert abs(sum(len(trial.t) for trial in five) - SAMPLES) <= 3


def test_a_law_without_a_gain_has_none():
    assert under(true_arm(), "p", 5.5).control.kv == ()
    assert under(true_arm(), "pda", 9.5, -9.5, -1.5).control.ka == (-1.5, -1.5)


def test_an_arm_that_is_held_begins_at_the_target_before():
    arm = under(true_arm(), "p", 9.5)
    goals = targets(Bench(learning=3, evaluating=0), arm.n_joint, 5)
    for trial, before, goal in zip(
        bench_trials(arm, 3000, seed=5, learning=3, held=True), goals[:-1], goals[1:], strict=True
    ):
        np.testing.assert_allclose(trial.q[0], before, atol=1e-12)
        np.testing.assert_allclose(trial.dq[0], 0.0, atol=1e-12)
        np.testing.assert_allclose(trial.ref[-1], goal)


@settings(max_examples=5, deadline=None)
@given(share=st.floats(0.001, 0.3), seed=st.integers(0, 1000))
def test_noise_is_white_and_as_large_as_was_asked_for(trials, share, seed):
    seen = noisy_trials(trials, share, seed, "exact")
    noise = np.concatenate([a.q - b.q for a, b in zip(seen, trials, strict=True)])
    np.testing.assert_allclose(noise.std(axis=0), share * angle_spread(trials), rtol=0.02)
    neighbours = np.mean(noise[1:] * noise[:-1], axis=0) / np.mean(noise**2, axis=0)
    assert np.abs(neighbours).max() < 0.03
    assert seen[0].dq is trials[0].dq
    assert seen[0].tau is None
    assert seen[0].tip is None


def test_the_same_seed_gives_the_same_noise_and_another_share_another(trials):
    first, again = (noisy_trials(trials, 0.05, 1, "exact")[0].q for _ in range(2))
    np.testing.assert_array_equal(first, again)
    other = noisy_trials(trials, 0.1, 1, "exact")[0].q - trials[0].q
    assert np.abs(np.corrcoef(other.ravel(), (first - trials[0].q).ravel())[0, 1]) < 0.05


def test_differences_are_exact_for_a_parabola_and_stamped_where_they_belong():
    t = np.arange(200) * 0.01
    q = np.column_stack([t**2, 1.0 - 3.0 * t])
    trial = Trial("x", t, 0.01, q, q, q, ref=np.repeat(t[:, None], 2, axis=1))
    seen = noisy_trials([trial], 0.0, 0, "differences")[0]
    inner = slice(2, -2)
    np.testing.assert_allclose(seen.ddq[inner], np.tile([2.0, 0.0], (len(seen.t), 1))[inner], atol=1e-9)
    # the mean of four belongs between the second and the third of them
    between = t[: len(seen.t)] + 0.015
    np.testing.assert_allclose(seen.dq[inner, 0], 2.0 * between[inner], atol=1e-9)
    assert np.abs(seen.ref[:, 0] - between).max() < 0.0051


def test_filtered_trials_keep_the_angles_as_they_were_measured(trials):
    seen = noisy_trials(trials, 0.05, 0, "filtered")[0]
    exact = noisy_trials(trials, 0.05, 0, "exact")[0]
    np.testing.assert_array_equal(seen.whole["q"], exact.q)
    assert np.std(seen.q - trials[0].q[seen.trimmed : len(trials[0].q) - seen.trimmed]) < 0.02
