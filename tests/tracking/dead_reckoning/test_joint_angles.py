"""Angles from positions, and how links are turned by them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arm.kinematics import axis_frames, sensor_positions
from arm.model import Arm, Joint, Sensor
from tracking.dead_reckoning.integration_state import reckoning_of
from tracking.dead_reckoning.joint_angles import (
    angles,
    carried_on,
    cosine_sine,
    direction,
    link_rotations,
    standing,
)

FEW = settings(max_examples=50, deadline=None)
SEEDS = st.integers(0, 2**32 - 1)


def random_chain(rng):
    """Return a chain of both kinds of joints with sensors anywhere on its links."""
    joints, sensors = [], []
    for i in range(int(rng.integers(1, 6))):
        slides = rng.random() < 0.4
        alpha, beta, offset = rng.uniform(-2.0, 2.0, 3).tolist()
        a, d = rng.uniform(-0.5, 0.5, 2).tolist()
        joints.append(Joint("prismatic" if slides else "revolute", alpha, a, d, beta, offset))
        for k in range(1 if slides else 2):
            at = rng.uniform(-0.1, 0.1, 3) + [0.3 * k, 0.1, 0.0]
            x, y, z = at.tolist()
            sensors.append(Sensor(f"s{i}{k}", i + 1, (x, y, z)))
    return Arm("chain", tuple(joints), sensors=tuple(sensors))


@FEW
@given(SEEDS)
def test_positions_give_the_angles_back(seed):
    rng = np.random.default_rng(seed)
    arm = random_chain(rng)
    n = arm.n_joint
    q0 = rng.uniform(-3.0, 3.0, n)
    state = reckoning_of(arm, q0)
    R, before, pair, facing = np.empty((n, 3, 3)), np.empty((n, 3, 3)), np.empty((n, 2)), np.empty((n, 2))
    standing(state, before, pair, facing)
    q = q0.copy()
    for _ in range(4):  # in steps of less than half a turn, so that whole turns are counted
        q = q + rng.uniform(-3.0, 3.0, n)
        state.moved[:] = sensor_positions(arm, q)[0] - state.start
        angles(state, before, pair, R, np.empty(3), facing)
        np.testing.assert_allclose(state.q, q, rtol=0, atol=1e-9)
        np.testing.assert_allclose(R, axis_frames(arm, q)[0, :, :3, :3], rtol=0, atol=1e-9)


@FEW
@given(SEEDS)
def test_readings_are_turned_by_the_angles_of_their_own_instant(seed):
    """Positions are a sample behind the readings, so the angles are carried on by one step."""
    rng = np.random.default_rng(seed)
    arm = random_chain(rng)
    n = arm.n_joint
    state = reckoning_of(arm, rng.uniform(-3.0, 3.0, n))
    state.q_before[:] = state.q - rng.uniform(-0.1, 0.1, n)
    (R, before), (pair, facing, ahead) = np.empty((2, n, 3, 3)), np.empty((3, n, 2))
    standing(state, before, pair, facing)
    carried_on(state, facing, ahead)
    link_rotations(ahead, before, R)
    q = 2 * state.q - state.q_before
    np.testing.assert_allclose(R, axis_frames(arm, q)[0, :, :3, :3], rtol=0, atol=1e-12)


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-4, 0.0029999, 0.0030001, 1.0, 3.0])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_what_stands_for_trigonometry_is_as_exact(size, sign):
    angle = sign * size
    assert cosine_sine(angle) == pytest.approx((np.cos(angle), np.sin(angle)), rel=0, abs=2.3e-16)
    assert direction(1.7 * np.cos(angle), 1.7 * np.sin(angle)) == pytest.approx(angle, rel=4e-16)
