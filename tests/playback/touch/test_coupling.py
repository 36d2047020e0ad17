"""Spring, damper and rotations, against what they must obey."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from playback.touch.coupling import spring_and_damper, spring_energy
from playback.touch.rotation import rotation_of, rotation_vector, turned_between

UNHURRIED = settings(deadline=None)  # the first call may compile

VECTOR = st.tuples(*[st.floats(-2.0, 2.0)] * 3)


@UNHURRIED
@given(st.floats(0.0, 5000.0), st.floats(0.1, 50.0), st.floats(1e-3, 1.0))
def test_the_pull_is_the_slope_of_the_energy(stiffness: float, limit: float, stretch: float) -> None:
    force = spring_and_damper(stiffness, 0.0, limit, (stretch, 0.0, 0.0), (0.0, 0.0, 0.0))
    h = 1e-6
    ahead, behind = (spring_energy(stiffness, limit, stretch + side * h) for side in (1.0, -1.0))
    assert force[0] == pytest.approx((ahead - behind) / (2.0 * h), rel=1e-3, abs=1e-6)
    assert force[0] == pytest.approx(min(stiffness * stretch, limit))


@UNHURRIED
@given(st.floats(0.0, 5000.0), st.floats(0.0, 100.0), st.floats(0.1, 50.0), VECTOR, VECTOR)
def test_the_limit_is_kept_and_the_damper_never_pushes(stiffness, damping, limit, e, de) -> None:
    both = np.array(spring_and_damper(stiffness, damping, limit, e, de))
    spring = np.array(spring_and_damper(stiffness, 0.0, limit, e, (0.0, 0.0, 0.0)))
    assert np.linalg.norm(both) <= limit * (1.0 + 1e-9)
    taken = float((both - spring) @ de)  # the power that the damper takes
    assert -1e-9 * (1.0 + limit) <= taken <= damping * float(np.dot(de, de)) + 1e-9 * (1.0 + limit)


@UNHURRIED
@given(VECTOR)
def test_rotations_are_scipys(vector) -> None:
    R = np.empty((3, 3))
    rotation_of(*vector, R)
    np.testing.assert_allclose(R, Rotation.from_rotvec(vector).as_matrix(), rtol=0, atol=1e-12)
    back = np.array(rotation_vector(R))
    np.testing.assert_allclose(Rotation.from_rotvec(back).as_matrix(), R, rtol=0, atol=1e-12)
    assert np.linalg.norm(back) <= np.pi + 1e-12


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0, -0.8), (-0.48, 0.6, 0.64)])
@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, 3.0, np.pi - 1e-7, np.pi])
def test_no_angle_is_a_bad_one(axis, angle) -> None:
    vector = angle * np.array(axis, dtype=float)
    R, room = np.empty((3, 3)), np.empty((3, 3))
    rotation_of(*vector, R)
    found = np.array(turned_between(R, np.eye(3), room))
    away = min(np.linalg.norm(found - vector), np.linalg.norm(found + vector) if angle == np.pi else np.inf)
    assert away < 1e-7 * (angle + 1e-3)
