"""Effects of the arm itself: what they do to a view of a motion, and what a tilt can be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from arm.effects.catalogue import catalogue
from arm.model import STANDARD_GRAVITY_M_S2, Effect
from fitter.diagnosis.arm_hypotheses import FrictionDrift, GravityTilt, JointZero
from fitter.diagnosis.diagnosis import diagnose
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import as_measured
from tests.fitter.diagnosis.test_payload import regression_of
from tests.fitter.diagnosis.two_joints import regression_of_two
from tests.fitter.pendulum import pendulum, swings

PARTS = st.floats(-15.0, 15.0)
DRIFT = Effect("thermal_drift", {"rate_1_s": 0.05}, joints=(1,))


@pytest.fixture(scope="module")
def hypothetical():
    regression = regression_of_two(trials=2)
    return as_measured(regression.motions[0], regression.arm)


@given(PARTS, PARTS)
def test_a_tilt_is_no_larger_than_gravity_and_keeps_its_direction(x, y):
    tilt = GravityTilt(catalogue()["gravity_tilt"], ())
    gx, gy = tilt.numbers(np.array([x, y]), np.zeros(0))
    assert np.hypot(gx, gy) == pytest.approx(min(np.hypot(x, y), STANDARD_GRAVITY_M_S2))
    assert gx * y == pytest.approx(gy * x, abs=1e-9)


def test_a_tilt_is_added_to_the_gravity_of_the_file(hypothetical):
    tilt = GravityTilt(catalogue()["gravity_tilt"], ())
    tilted = tilt.act(hypothetical, np.array([0.3, -20.0])).arm
    added = np.subtract(tilted.gravity_m_s2, hypothetical.arm.gravity_m_s2)
    np.testing.assert_allclose(added, [*tilt.numbers(np.array([0.3, -20.0]), np.zeros(0)), 0.0], atol=1e-12)


def test_a_zero_turns_one_joint_and_leaves_the_measured_motion(hypothetical):
    turned = JointZero(catalogue()["joint_zero"], (1,)).act(hypothetical, np.array([0.2]))
    np.testing.assert_allclose(turned.q - hypothetical.q, np.array([0.0, 0.2]) * np.ones_like(hypothetical.q))
    assert turned.motion is hypothetical.motion


def test_the_columns_of_friction_grow_and_no_others():
    regression = regression_of(DRIFT)
    motion = regression.motions[2]
    plain = regression.hypothetical(Model(), motion)
    drifting = FrictionDrift(catalogue()["thermal_drift"], (0,)).act(plain, np.array([0.05]))
    kept = regression.equations.independent(regression.arm)
    was, is_now = plain.base(kept), drifting.base(kept)
    friction = kept >= 10
    grown = (1.0 + 0.05 * motion.t)[:, None, None]
    np.testing.assert_allclose(is_now[..., friction], was[..., friction] * grown)
    np.testing.assert_array_equal(is_now[..., ~friction], was[..., ~friction])


def test_its_rate_is_found():
    motions = swings((DRIFT,), trials=8)
    (cause,) = diagnose(pendulum(), motions[:4], motions[4:]).finding.causes
    rate = cause.parameters["rate_1_s"]
    assert (cause.effect, cause.joints) == ("thermal_drift", (1,))
    assert rate.value == pytest.approx(0.05, abs=3.0 * rate.std)
