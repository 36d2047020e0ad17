"""The built-in arms: possible ones, and the spatial arm does what a bench needs of it."""

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.arm_file import load_arm, preset_names
from arm.bench import Bench, motions, rest_angles
from arm.chain import chain_of
from arm.control import control_torque
from arm.counts import FULL_SCALE_M_S2
from arm.kinematics import axis_frames, sensor_positions, tip_position
from arm.newton_euler import bias_torque
from arm.physical_links import is_possible

#: Arms with accelerometers; those of persons have none until somebody straps them on.
MEASURED = [name for name in preset_names() if load_arm(name).sensors]
BENCH = Bench(rate_hz=1000.0, learning=4, evaluating=0)


@pytest.fixture(scope="module")
def spatial():
    return load_arm("spatial-arm")


@pytest.fixture(scope="module")
def trials(spatial):
    return [motion for seed in (0, 1) for motion in motions(spatial, BENCH, seed)]


@pytest.mark.parametrize("name", preset_names())
def test_every_link_that_weighs_anything_could_exist(name):
    assert all(is_possible(link) for link in chain_of(load_arm(name)).inertial if link.any())


@pytest.mark.parametrize("name", MEASURED)
def test_two_sensors_of_every_link_lie_apart_across_its_axis(name):
    arm = load_arm(name)
    for i in range(arm.n_joint):
        one, two = (np.array(sensor.position_m) for sensor in arm.sensors if sensor.joint == i + 1)
        assert np.hypot(*(two - one)[:2]) > 0.1


@pytest.mark.parametrize("name", MEASURED)
def test_the_tip_is_at_the_end_of_the_last_link(name):
    arm = load_arm(name)
    q = np.random.default_rng(0).uniform(-1.2, 1.2, (20, arm.n_joint))
    turn = axis_frames(arm, q)[:, -1, :3, :3]
    measured = sensor_positions(arm, q)[:, arm.sensor_index(arm.tip.sensor)] + turn @ np.array(arm.tip.offset_m)
    np.testing.assert_allclose(measured, tip_position(arm, q), rtol=0, atol=1e-15)


def test_the_spatial_arm_turns_about_the_vertical_and_then_pitches(spatial):
    stretched = tip_position(spatial, np.zeros((1, 3)))[0]
    np.testing.assert_allclose(stretched, [0.55, 0.0, 0.3], rtol=0, atol=1e-15)
    turned, raised, bent = tip_position(spatial, np.pi / 2 * np.eye(3))
    np.testing.assert_allclose(turned, [0.0, 0.55, 0.3], rtol=0, atol=1e-15)
    np.testing.assert_allclose(raised, [0.0, 0.0, 0.85], rtol=0, atol=1e-15)
    np.testing.assert_allclose(bent, [0.3, 0.0, 0.55], rtol=0, atol=1e-15)


def test_the_spatial_arm_rests_a_few_degrees_below_its_target(spatial):
    q, still = rest_angles(spatial, np.zeros(3)), np.zeros((1, 3))
    pull = control_torque(spatial.control, q[None], still, still, still) - bias_torque(spatial, q, still)
    held = [max(joint.friction.static_N_m, joint.friction.coulomb_N_m) for joint in spatial.joints]
    assert np.all(np.abs(pull[0]) <= held)
    assert np.all(np.abs(q) < np.deg2rad(4.0)) and q[1] < np.deg2rad(-2.0)


def test_the_spatial_arm_reaches_its_targets_and_rests(trials):
    for motion in trials:
        moving_s = motion.t - BENCH.rest_s
        end = motion.q[-1]
        assert np.abs(end - motion.ref[-1]).max() < np.deg2rad(4.0)
        assert np.abs(motion.q[moving_s >= 2.0] - end).max() < 0.01
        assert np.abs(motion.dq[motion.t >= 6.25]).max() < 1e-3
        beyond = (motion.q - end) * np.sign(end - motion.q[0])
        assert beyond.max() < 0.1  # well damped, though the joints shake each other


def test_neither_motors_nor_sensors_of_the_spatial_arm_are_asked_for_too_much(spatial, trials):
    for motion in trials:
        assert np.abs(motion.tau).max() < 120.0
        assert np.abs(specific_force(spatial, motion.q, motion.dq, motion.ddq)).max() < 0.7 * FULL_SCALE_M_S2
    assert max(np.abs(motion.tau).max() for motion in trials) > 20.0
