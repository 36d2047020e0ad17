"""Payloads, zeros and tilts, and what sensors read of an arm with effects."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.bench import Bench, SensorErrors, Sensors, motions, rest_angles
from arm.counts import COUNT_M_S2
from arm.effects.effect_table import changed
from arm.effects.resisting_torque import resisting_torque
from arm.effects.time_skew import Skew
from arm.model import Effect, Link
from arm.newton_euler import inverse_dynamics
from arm.simulation import GearedMotion, simulate
from limbcal.errors import ConfigError, DataError

DT = 1e-3
SMALL = Bench(rate_hz=2000.0, trial_s=0.6, rest_s=0.1, learning=2, evaluating=2)


def with_point(arm, mass):
    """Return the arm with a point at its tip, put together of centre of mass and Steiner's theorem."""
    last, old = arm.joints[-1], arm.joints[-1].link
    com = (old.mass_kg * np.array(old.com_m) + mass * np.array([last.a_m, 0.0, 0.0])) / (old.mass_kg + mass)
    inertia = np.array(old.inertia_kg_m2) + mass * last.a_m**2 * np.array([0.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    link = Link(old.mass_kg + mass, tuple(com.tolist()), tuple(inertia.tolist()))
    return replace(arm, joints=(*arm.joints[:-1], replace(last, link=link)))


def run(arm, n=800, **options):
    ref = 0.2 + np.sin(np.arange(n)[:, None] * DT * np.array([4.0, 5.0, 6.0]))
    return simulate(arm, ref, DT, np.full(3, 0.2), **options)


def test_a_payload_is_a_point_at_the_tip_in_its_trials(arm, having):
    loaded, point = having(arm, "payload", mass_kg=0.7, trials=[2, 4]), with_point(arm, 0.7)
    for trial in (1, 2, 3, 4):
        expected = run(point if trial in (2, 4) else arm)
        np.testing.assert_allclose(run(loaded, trial=trial).q, expected.q, rtol=0, atol=1e-11)
    np.testing.assert_allclose(run(having(arm, "payload", mass_kg=0.7)).q, run(point).q, rtol=0, atol=1e-11)


def test_a_payload_since_some_time_is_taken_up_on_the_way(arm, having):
    loaded = having(arm, "payload", mass_kg=0.7, since_s=10.3)
    motion, plain = run(loaded, t0_s=10.0), run(arm)
    np.testing.assert_array_equal(motion.q[:300], plain.q[:300])
    rest = simulate(with_point(arm, 0.7), motion.ref[300:], DT, motion.q[300], motion.dq[300])
    np.testing.assert_allclose(motion.q[300:], rest.q, rtol=0, atol=1e-11)
    for t0, same in ((11.0, with_point(arm, 0.7)), (0.0, arm)):
        np.testing.assert_allclose(run(loaded, t0_s=t0).q, run(same).q, rtol=0, atol=1e-11)


def test_the_torque_beyond_the_rigid_arm(arm, having):
    loaded = having(having(arm, "payload", mass_kg=0.7, since_s=0.4), "rotor_inertia", joint=2, inertia_kg_m2=0.2)
    loaded = having(loaded, "joint_zero", joint=2, offset_rad=0.3)
    motion = run(loaded)
    wanted = inverse_dynamics(changed(loaded), motion.q, motion.dq, motion.ddq)
    wanted += resisting_torque(loaded, motion.q, motion.dq, motion.ddq, motion.tau, motion.t)
    moving = np.all(motion.dq != 0.0, axis=1)
    np.testing.assert_allclose(wanted[moving], motion.tau[moving], rtol=0, atol=1e-9)
    with pytest.raises(DataError, match=r"t has shape \(3,\), expected \(800,\)"):
        resisting_torque(loaded, motion.q, motion.dq, motion.ddq, motion.tau, motion.t[:3])


def test_a_zero_that_is_off_moves_the_link(arm, having):
    """The arm whose angles are counted from elsewhere moves alike, but for the count."""
    off = changed(having(arm, "joint_zero", joint=2, offset_rad=0.3))
    q, rng = np.full((1, 3), 0.2), np.random.default_rng(0)
    dq, ddq = rng.normal(size=(2, 1, 3))
    turned = q + [0.0, 0.3, 0.0]
    np.testing.assert_allclose(
        inverse_dynamics(off, q, dq, ddq), inverse_dynamics(arm, turned, dq, ddq), atol=1e-12
    )
    sliding = replace(arm, joints=(arm.joints[0], replace(arm.joints[1], type="prismatic"), arm.joints[2]))
    off = changed(having(sliding, "joint_zero", joint=2, offset_rad=0.3))
    np.testing.assert_allclose(
        inverse_dynamics(off, q, dq, ddq), inverse_dynamics(sliding, turned, dq, ddq), atol=1e-12
    )


def perfect(arm):
    shape = (len(arm.sensors), 3)
    return SensorErrors(0.0, np.zeros(shape), np.ones(shape), np.zeros(shape), np.zeros(shape))


def read(arm, parts):
    """Return readings [m/s^2] of motions one after the other, (n_sample, n_sensor, 3)."""
    sensors = Sensors(arm, perfect(arm), 1.0 / DT, np.random.default_rng(0))
    counts = np.vstack([sensors.counts(part) for part in parts])
    return counts.reshape(len(counts), -1, 3) * COUNT_M_S2


def of_sensor(arm, name, **numbers):
    return replace(arm, effects=(Effect(name, numbers, (), () if name == "base_motion" else ("s3",)),))


def test_only_its_own_sensor_and_on_the_runs_clock(arm):
    motion = run(arm)
    plain = read(arm, [motion, motion])
    drifting = read(of_sensor(arm, "sensor_drift", x_m_s3=0.5, y_m_s3=-0.2, z_m_s3=0.0), [motion, motion])
    t = np.arange(1600) * DT
    np.testing.assert_allclose((drifting - plain)[:, 2, 0], 0.5 * t, rtol=0, atol=COUNT_M_S2)
    np.testing.assert_allclose((drifting - plain)[:, 2, 1], -0.2 * t, rtol=0, atol=COUNT_M_S2)
    np.testing.assert_array_equal(np.delete(drifting, 2, axis=1), np.delete(plain, 2, axis=1))


def test_a_sensor_clips_what_it_would_have_read(arm):
    motion = run(arm)
    plain, clipped = read(arm, [motion]), read(of_sensor(arm, "sensor_clipping", level_m_s2=6.0), [motion])
    assert np.abs(plain[:, 2]).max() > 7.0
    np.testing.assert_allclose(clipped[:, 2], np.clip(plain[:, 2], -6.0, 6.0), rtol=0, atol=COUNT_M_S2)


def test_a_base_that_moves_is_felt_as_gravity_that_sways(arm):
    """To an arm that is held still it is as though gravity pointed elsewhere."""
    still = np.tile([0.3, -0.4, 0.9], (400, 1))
    motion = replace(run(arm, 400), q=still, dq=0 * still, ddq=0 * still)
    found = read(of_sensor(arm, "base_motion", x_m_s2=0.5, y_m_s2=0.0, z_m_s2=-0.3, frequency_hz=7.0), [motion])
    for k in (10, 100, 333):
        wave = np.sqrt(2.0) * np.sin(2 * np.pi * 7.0 * k * DT)
        gravity = np.array(arm.gravity_m_s2) - wave * np.array([0.5, 0.0, -0.3])
        swayed = specific_force(replace(arm, gravity_m_s2=tuple(gravity)), still[:1], 0 * still[:1], 0 * still[:1])
        np.testing.assert_allclose(found[k], swayed[0], rtol=0, atol=COUNT_M_S2)


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 3.7, 12.5])
def test_late_readings_are_those_of_some_time_ago(delay):
    wave = lambda k: np.column_stack([np.sin(0.1 * k), np.cos(0.07 * k)])  # noqa: E731
    skew = Skew(delay)
    k = np.arange(300.0)
    late = np.vstack([skew.apply(part) for part in np.split(wave(k), [7, 8, 150])])
    np.testing.assert_allclose(late[20:], wave(k - delay)[20:], rtol=0, atol=1e-4)
    assert np.all(late[0] == pytest.approx(wave(k)[0]))


def test_sensors_ride_on_links_and_not_on_motors(arm, having):
    arm = having(arm, "joint_elasticity", joint=2, stiffness_N_m_rad=100.0, damping_N_m_s=1.0)
    motion = run(arm)
    assert isinstance(motion, GearedMotion) and np.abs(motion.q - motion.link_q).max() > 0.02
    expected = specific_force(arm, motion.link_q, motion.link_dq, motion.link_ddq)
    np.testing.assert_allclose(read(arm, [motion]), expected, rtol=0, atol=COUNT_M_S2)


def test_the_bench_counts_trials_and_time(arm, having):
    target = np.zeros(3)
    plain = [motion.q for motion in motions(arm, SMALL, 3)]
    loaded = [motion.q for motion in motions(having(arm, "payload", mass_kg=1.0, trials=[3]), SMALL, 3)]
    pushed = having(arm, "external_push", start_s=1.3, duration_s=0.1, torque_N_m=3.0)
    pushes = [motion.q for motion in motions(pushed, SMALL, 3)]
    for trial in (0, 1):
        np.testing.assert_array_equal(loaded[trial], plain[trial])
        np.testing.assert_array_equal(pushes[trial], plain[trial])
    assert np.abs(loaded[2] - plain[2]).max() > 1e-3
    assert np.abs(pushes[2] - plain[2])[:200].max() == 0.0 and np.abs(pushes[2] - plain[2]).max() > 1e-3
    np.testing.assert_array_equal(rest_angles(pushed, target), rest_angles(arm, target))


def test_the_bench_keeps_links_and_motors_apart(arm, having):
    arm = having(arm, "joint_elasticity", stiffness_N_m_rad=200.0, damping_N_m_s=1.0)
    motion = next(motions(arm, SMALL, 3))
    assert isinstance(motion, GearedMotion) and len(motion.link_q) == len(motion.q) == 1200
    lead = (motion.q - motion.link_q)[:, 0]
    np.testing.assert_allclose(lead[-1], motion.tau[-1, 0] / 200.0, rtol=0.2)


def test_effects_that_the_catalogue_has_not_are_named(arm):
    wrong = replace(arm, effects=(Effect("magic"), Effect("viscous", {"viscous_N_m_s": 0.1}, (4,))))
    with pytest.raises(ConfigError) as caught:
        run(wrong)
    assert len(caught.value.mistakes) == 2
    assert caught.value.mistakes[1] == "effect[1].joints has 4, expected 1 to 3"
