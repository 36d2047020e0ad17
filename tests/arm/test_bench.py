"""The standard bench: the same by the same seed, at rest where it says so, counts as a converter gives them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.accelerometer import specific_force
from arm.bench import (
    COUNT_M_S2,
    FULL_SCALE_M_S2,
    Bench,
    SensorErrors,
    counts,
    densify,
    draw_sensor_errors,
    motions,
    mounted,
    rest_angles,
    targets,
)
from arm.control import control_torque
from arm.model import Control
from arm.newton_euler import bias_torque
from arm.simulation import Motion
from limbcal.errors import ConfigError

FEW = settings(max_examples=30, deadline=None)
SMALL = Bench(rate_hz=8000.0, trial_s=2.0, rest_s=0.5, learning=2, evaluating=1)


@pytest.fixture(scope="module")
def trials(dd_arm):
    return list(motions(dd_arm, SMALL, 5))


def test_the_standard_bench_is_the_papers():
    bench = Bench()
    assert (bench.rate_hz, bench.trial_s, bench.rest_s, bench.trials) == (32000.0, 6.75, 0.5, 22)
    assert (bench.learning, bench.evaluating, bench.span_rad) == (5, 17, 1.2)


def test_five_learning_trials_are_about_as_many_samples_as_the_paper_counts():
    """At 32 kHz five motions of 6.75 s make 1080000 samples; the paper counts 1054688, at 32 us a sample."""
    assert 5 * 6.75 * 32000 == 1_080_000
    assert round(5 * 6.75 / 32e-6) == pytest.approx(1_054_688, abs=1)


def test_the_same_seed_makes_the_same_motion_and_another_one_another(dd_arm, trials):
    again = list(motions(dd_arm, SMALL, 5))
    assert len(again) == 3
    for one, two in zip(trials, again, strict=True):
        np.testing.assert_array_equal(one.q, two.q)
        np.testing.assert_array_equal(one.ddq, two.ddq)
    assert np.abs(next(motions(dd_arm, SMALL, 6)).q - trials[0].q).max() > 0.1


def test_targets_lie_within_the_span_and_begin_at_zero():
    goals = targets(Bench(), 3, 1)
    assert goals.shape == (23, 3)
    np.testing.assert_array_equal(goals[0], 0.0)
    assert 1.0 < np.abs(goals).max() <= 1.2


def test_a_trial_rests_and_then_moves_to_its_target(dd_arm, trials):
    goals = targets(SMALL, 2, 5)
    for k, motion in enumerate(trials):
        assert len(motion.t) == 16000 and motion.t[0] == 0.0
        np.testing.assert_array_equal(motion.ref[motion.t < 0.4999], [goals[k]] * 4000)
        np.testing.assert_array_equal(motion.ref[motion.t >= 0.5], [goals[k + 1]] * 12000)
    first = trials[0]
    np.testing.assert_array_equal(first.q[first.t <= 0.49975], 0.0)
    assert np.abs(first.ddq[first.t > 0.5]).max() > 1.0


def test_trials_follow_each_other_without_a_jump(trials):
    step = 1.0 / SMALL.rate_hz
    for before, after in zip(trials[:-1], trials[1:], strict=True):
        ahead = before.q[-1] + step * before.dq[-1] + step**2 / 2 * before.ddq[-1]
        np.testing.assert_allclose(after.q[0], ahead, rtol=0, atol=1e-9)


def test_the_hanging_arm_starts_in_equilibrium(vertical_arm):
    """It hangs far from the target that pulls at it. Friction that pushes (fc2 < 0) lets it creep, no more."""
    q = rest_angles(vertical_arm, np.zeros(2))
    still = np.zeros((1, 2))
    pull = control_torque(vertical_arm.control, q[None], still, still, still) - bias_torque(vertical_arm, q, still)
    assert np.abs(pull).max() < 0.011 and np.abs(q).max() > 1.0
    motion = next(motions(vertical_arm, SMALL, 1))
    np.testing.assert_allclose(motion.q[motion.t < 0.4999], np.tile(q, (4000, 1)), rtol=0, atol=2e-4)


def test_an_arm_without_a_law_is_not_driven(dd_arm):
    with pytest.raises(ConfigError, match=r"arm 'dd-arm': control.law is 'measured'; the bench needs 'pd', 'pda'"):
        next(motions(replace(dd_arm, control=Control()), SMALL, 0))


def polynomial_motion(coefficients, t):
    """Return a motion of one joint along a polynomial."""
    q = np.polynomial.Polynomial(coefficients)
    columns = [f(t)[:, None] for f in (q, q.deriv(), q.deriv(2))]
    return Motion(t, *columns, np.zeros((len(t), 1)), np.arange(len(t), dtype=float)[:, None])


@FEW
@given(st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6), st.sampled_from([1000.0, 3333.0, 8000.0]))
def test_densify_is_exact_on_quintics(coefficients, rate_hz):
    coarse = polynomial_motion(coefficients, np.arange(51) * 0.02)
    dense = densify(coarse, rate_hz, int(rate_hz))
    true = polynomial_motion(coefficients, np.arange(int(rate_hz)) / rate_hz)
    np.testing.assert_allclose(dense.t, true.t, rtol=0, atol=1e-15)
    np.testing.assert_allclose(dense.q, true.q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(dense.dq, true.dq, rtol=0, atol=1e-10)
    np.testing.assert_allclose(dense.ddq, true.ddq, rtol=0, atol=1e-8)


def test_densify_goes_through_what_it_is_given_and_holds_the_target(dd_arm):
    rng = np.random.default_rng(0)
    t = np.arange(21) * 0.05
    coarse = Motion(t, *rng.normal(size=(5, 21, 2)))
    dense = densify(coarse, 200.0, 201)
    for name in ("q", "dq", "ddq", "tau", "ref"):
        np.testing.assert_allclose(getattr(dense, name)[::10], getattr(coarse, name), rtol=0, atol=1e-9)
    np.testing.assert_array_equal(dense.ref[5], coarse.ref[0])


def test_the_derivatives_belong_to_the_angles(trials):
    """Differences of angles give the velocities, differences of these the accelerations."""
    motion, step = trials[1], 1.0 / SMALL.rate_hz
    part = slice(4100, 15900)  # away from the jumps of acceleration
    for of, derivative, tolerance in ((motion.q, motion.dq, 1e-5), (motion.dq, motion.ddq, 1e-2)):
        found = np.gradient(of, step, axis=0)[part]
        np.testing.assert_allclose(found, derivative[part], rtol=0, atol=tolerance)


def test_a_motion_that_is_too_short_is_told():
    with pytest.raises(ConfigError, match="a motion of 1 s cannot give 1200 samples at 1000 Hz"):
        densify(polynomial_motion([0.0, 1.0], np.arange(51) * 0.02), 1000.0, 1200)


def perfect(arm):
    return draw_sensor_errors(arm, np.random.default_rng(0), noise=0.0)


def test_counts_are_what_the_sensors_read_in_steps_of_the_converter(dd_arm, trials):
    motion = trials[0]
    found = counts(dd_arm, perfect(dd_arm), motion, np.random.default_rng(0))
    assert found.dtype == np.int16 and found.shape == (16000, 12)
    true = specific_force(dd_arm, motion.q, motion.dq, motion.ddq).reshape(-1, 12)
    assert np.abs(found * COUNT_M_S2 - true).max() <= COUNT_M_S2 / 2 * (1 + 1e-9)
    assert 2**15 * COUNT_M_S2 == pytest.approx(5 * 9.80665) == FULL_SCALE_M_S2


def test_counts_are_clipped_and_not_wrapped(dd_arm, trials):
    errors = replace(perfect(dd_arm), bias_m_s2=np.array([[60.0, -60.0, 0.0]] * 4))
    found = counts(dd_arm, errors, trials[0], np.random.default_rng(0))
    assert np.all(found[:, 0::3] == 32767) and np.all(found[:, 1::3] == -32768)


def test_noise_and_bias_are_as_large_as_the_bench_says(dd_arm, trials):
    rest = replace(trials[0], **{name: getattr(trials[0], name)[:3900] for name in ("t", "q", "dq", "ddq")})
    biases, noises = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        errors = draw_sensor_errors(dd_arm, rng)
        read = counts(dd_arm, errors, rest, rng) * COUNT_M_S2 - [0.0, 0.0, 9.80665] * 4
        biases.append(read.mean(axis=0))
        noises.append(read.std(axis=0))
        np.testing.assert_allclose(read.mean(axis=0), errors.bias_m_s2.ravel(), rtol=0, atol=0.002)
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(biases))), 0.02, rtol=0.1)
    np.testing.assert_allclose(noises, 0.02, rtol=0.1)


def test_the_same_generator_makes_the_same_counts(dd_arm, trials):
    def run():
        rng = np.random.default_rng(3)
        return counts(dd_arm, draw_sensor_errors(dd_arm, rng), trials[0], rng)

    np.testing.assert_array_equal(run(), run())


def test_imperfect_mounting_moves_turns_and_scales(dd_arm):
    drawn = [draw_sensor_errors(dd_arm, np.random.default_rng(k), 0.0, True) for k in range(40)]

    def rms(name, around=0.0):
        return np.sqrt(np.mean([(getattr(e, name) - around) ** 2 for e in drawn]))

    assert rms("misalignment_rad") == pytest.approx(np.deg2rad(0.3), rel=0.15)
    assert rms("scale", 1.0) == pytest.approx(0.003, rel=0.15)
    assert rms("offset_m") == pytest.approx(0.0005, rel=0.15)
    sitting = mounted(dd_arm, drawn[0]).sensors[2]
    assert sitting.name == "s3" and sitting.joint == 2
    np.testing.assert_allclose(sitting.position_m, np.array([0.08, 0.0, 0.0]) + drawn[0].offset_m[2])
    assert rms("bias_m_s2") == 0.0


def test_good_mounting_is_the_arm_file(dd_arm):
    errors = draw_sensor_errors(dd_arm, np.random.default_rng(0))
    assert isinstance(errors, SensorErrors) and mounted(dd_arm, errors) == dd_arm
