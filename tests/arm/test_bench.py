"""The standard bench: the same by the same seed, at rest where it says so, counts as a converter gives them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.accelerometer import specific_force
from arm.bench import Bench, Sensors, densify, draw_sensor_errors, motions, rest_angles, targets, with_errors
from arm.control import control_torque
from arm.counts import COUNT_M_S2, FULL_SCALE_M_S2
from arm.highpass import HighPass
from arm.model import Control, Sensor
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
    away = slice(4100, 15900)  # away from the jumps of acceleration
    for of, derivative, tolerance in ((motion.q, motion.dq, 1e-5), (motion.dq, motion.ddq, 1e-2)):
        found = np.gradient(of, step, axis=0)[away]
        np.testing.assert_allclose(found, derivative[away], rtol=0, atol=tolerance)


def test_a_motion_that_is_too_short_is_told():
    with pytest.raises(ConfigError, match="a motion of 1 s cannot give 1200 samples at 1000 Hz"):
        densify(polynomial_motion([0.0, 1.0], np.arange(51) * 0.02), 1000.0, 1200)


def perfect(arm):
    return draw_sensor_errors(arm, np.random.default_rng(0), noise=0.0)


def read(arm, errors, motion, seed=0):
    return Sensors(arm, errors, SMALL.rate_hz, np.random.default_rng(seed)).counts(motion)


def part(motion, rows):
    return Motion(*(values[rows] for values in vars(motion).values()))


def with_sensors(arm, **fields):
    return replace(arm, sensors=tuple(replace(sensor, **fields) for sensor in arm.sensors))


def test_counts_are_what_the_sensors_read_in_steps_of_the_converter(dd_arm, trials):
    motion = trials[0]
    found = read(dd_arm, perfect(dd_arm), motion)
    assert found.dtype == np.int16 and found.shape == (16000, 12)
    true = specific_force(dd_arm, motion.q, motion.dq, motion.ddq).reshape(-1, 12)
    assert np.abs(found * COUNT_M_S2 - true).max() <= COUNT_M_S2 / 2 * (1 + 1e-9)
    assert 2**15 * COUNT_M_S2 == pytest.approx(5 * 9.80665) == FULL_SCALE_M_S2


def test_the_standard_benchs_counts_are_scaled_force_and_bias_and_noise_to_the_last_bit(dd_arm, trials):
    """With sensors that forget nothing; the generator that drew the errors goes on to draw the noise."""
    rng, again = np.random.default_rng([3, 2]), np.random.default_rng([3, 2])
    errors = draw_sensor_errors(dd_arm, rng, imperfect_mounting=True)
    sensors = Sensors(dd_arm, errors, SMALL.rate_hz, rng)
    draws = again.normal(size=(4, 4, 3))
    mounted = tuple(
        Sensor(
            sensor.name,
            sensor.joint,
            tuple((np.array(sensor.position_m) + 0.0005 * draws[3, k]).tolist()),
            tuple((np.array(sensor.rotation_rad) + np.deg2rad(0.3) * draws[2, k]).tolist()),
        )
        for k, sensor in enumerate(dd_arm.sensors)
    )
    for motion in trials[:2]:
        force = specific_force(replace(dd_arm, sensors=mounted), motion.q, motion.dq, motion.ddq)
        reading = force * (1.0 + 0.003 * draws[1]) + 0.02 * draws[0] + 0.02 * again.standard_normal(force.shape)
        expected = np.rint(reading / COUNT_M_S2).reshape(-1, 12)
        np.testing.assert_array_equal(sensors.counts(motion), expected)


def test_scale_and_bias_of_the_arm_file_come_on_top_of_those_that_are_drawn(dd_arm, trials):
    errors = draw_sensor_errors(dd_arm, np.random.default_rng(1), imperfect_mounting=True)
    arm = with_sensors(dd_arm, scale=(1.1, 0.9, 1.05), bias_m_s2=(0.3, -0.2, 0.1))
    really = with_errors(arm, errors)
    for k, sensor in enumerate(really.sensors):
        np.testing.assert_allclose(sensor.scale, errors.scale[k] * [1.1, 0.9, 1.05], rtol=1e-15)
        np.testing.assert_allclose(sensor.bias_m_s2, errors.bias_m_s2[k] + [0.3, -0.2, 0.1], rtol=1e-15)
    silent, motion = replace(errors, noise_m_s2=0.0), trials[0]
    force = specific_force(really, motion.q, motion.dq, motion.ddq)
    expected = force * errors.scale * [1.1, 0.9, 1.05] + errors.bias_m_s2 + [0.3, -0.2, 0.1]
    found = read(arm, silent, motion) * COUNT_M_S2
    np.testing.assert_allclose(found, expected.reshape(-1, 12), rtol=0, atol=0.51 * COUNT_M_S2)


def test_an_ac_coupled_sensor_forgets_what_it_scales_but_neither_bias_nor_noise(dd_arm, trials):
    motion = trials[0]
    arm = with_sensors(dd_arm, highpass_hz=0.5, scale=(1.1, 0.9, 1.05), bias_m_s2=(0.3, -0.2, 0.1))
    found = read(arm, perfect(arm), motion) * COUNT_M_S2
    force = specific_force(arm, motion.q, motion.dq, motion.ddq).reshape(-1, 12)
    expected = force * ([1.1, 0.9, 1.05] * 4)
    HighPass(np.full(12, 0.5), SMALL.rate_hz).apply(expected)
    expected += [0.3, -0.2, 0.1] * 4
    np.testing.assert_allclose(found, expected, rtol=0, atol=0.51 * COUNT_M_S2)
    before = motion.t < 0.499
    np.testing.assert_allclose(found[before], [[0.3, -0.2, 0.1] * 4] * before.sum(), rtol=0, atol=COUNT_M_S2)
    loud = read(arm, replace(perfect(arm), noise_m_s2=0.5), motion) * COUNT_M_S2
    assert (loud - found).std() == pytest.approx(0.5, rel=0.02)
    assert abs((loud - found)[8000:].std() - (loud - found)[:8000].std()) < 0.01


def test_each_sensor_forgets_by_its_own_corner(dd_arm, trials):
    one, *others = dd_arm.sensors
    mixed = replace(dd_arm, sensors=(replace(one, highpass_hz=2.0), *others))
    found, plain = (read(arm, perfect(arm), trials[0]) for arm in (mixed, dd_arm))
    np.testing.assert_array_equal(found[:, 3:], plain[:, 3:])
    assert np.abs(found[:100, :3]).max() == 0 and plain[0, 2] == round(9.80665 / COUNT_M_S2)


def test_motions_follow_each_other_on_one_clock(dd_arm, trials):
    """What the sensors remember and the noise they make don't depend on how a motion comes in parts."""
    arm = with_sensors(dd_arm, highpass_hz=0.1)
    rng = np.random.default_rng(4)
    sensors = Sensors(arm, draw_sensor_errors(arm, rng), SMALL.rate_hz, rng)
    motion = trials[0]
    parts = [sensors.counts(part(motion, rows)) for rows in (slice(0, 1), slice(1, 9000), slice(9000, None))]
    rng = np.random.default_rng(4)
    whole = Sensors(arm, draw_sensor_errors(arm, rng), SMALL.rate_hz, rng).counts(motion)
    np.testing.assert_array_equal(np.concatenate(parts), whole)


def test_counts_are_clipped_and_not_wrapped(dd_arm, trials):
    errors = replace(perfect(dd_arm), bias_m_s2=np.array([[60.0, -60.0, 0.0]] * 4))
    found = read(dd_arm, errors, trials[0])
    assert np.all(found[:, 0::3] == 32767) and np.all(found[:, 1::3] == -32768)


def test_noise_and_bias_are_as_large_as_the_bench_says(dd_arm, trials):
    rest = part(trials[0], slice(0, 3900))
    biases, noises = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        errors = draw_sensor_errors(dd_arm, rng)
        sensors = Sensors(dd_arm, errors, SMALL.rate_hz, rng)
        beyond = sensors.counts(rest) * COUNT_M_S2 - [0.0, 0.0, 9.80665] * 4
        biases.append(beyond.mean(axis=0))
        noises.append(beyond.std(axis=0))
        np.testing.assert_allclose(beyond.mean(axis=0), errors.bias_m_s2.ravel(), rtol=0, atol=0.002)
    np.testing.assert_allclose(np.sqrt(np.mean(np.square(biases))), 0.02, rtol=0.1)
    np.testing.assert_allclose(noises, 0.02, rtol=0.1)


def test_imperfect_mounting_moves_turns_and_scales(dd_arm):
    drawn = [draw_sensor_errors(dd_arm, np.random.default_rng(k), 0.0, True) for k in range(40)]

    def rms(name, around=0.0):
        return np.sqrt(np.mean([(getattr(e, name) - around) ** 2 for e in drawn]))

    assert rms("misalignment_rad") == pytest.approx(np.deg2rad(0.3), rel=0.15)
    assert rms("scale", 1.0) == pytest.approx(0.003, rel=0.15)
    assert rms("offset_m") == pytest.approx(0.0005, rel=0.15)
    sitting = with_errors(dd_arm, drawn[0]).sensors[2]
    assert sitting.name == "s3" and sitting.joint == 2
    np.testing.assert_allclose(sitting.position_m, np.array([0.08, 0.0, 0.0]) + drawn[0].offset_m[2])
    assert rms("bias_m_s2") == 0.0


def test_good_sensors_are_the_arm_files(dd_arm):
    arm = with_sensors(dd_arm, scale=(1.1, 0.9, 1.05), bias_m_s2=(0.3, -0.2, 0.1), highpass_hz=0.2)
    assert with_errors(arm, perfect(arm)) == arm
