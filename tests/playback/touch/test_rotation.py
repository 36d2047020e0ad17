"""Rotations by their vectors, against scipy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from playback.touch.rotation import rotation_of, rotation_vector, turned_between, turned_on

UNHURRIED = settings(deadline=None)  # the first call may compile
VECTOR = st.tuples(*[st.floats(-2.0, 2.0)] * 3)


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


@UNHURRIED
@given(VECTOR, VECTOR, st.floats(0.0, 1.0))
def test_a_part_of_a_turn_goes_on_from_where_it_was(start, turn, part) -> None:
    R, room, out = Rotation.from_rotvec(start).as_matrix(), np.empty((3, 3)), np.empty((3, 3))
    turned_on(R, np.array(turn), part, room, out)
    expected = (Rotation.from_rotvec(part * np.array(turn)) * Rotation.from_rotvec(start)).as_matrix()
    np.testing.assert_allclose(out, expected, rtol=0, atol=1e-12)


@UNHURRIED
@given(VECTOR, VECTOR)
def test_what_lies_between_two_takes_one_to_the_other(one, other) -> None:
    A, B, out = Rotation.from_rotvec(one).as_matrix(), Rotation.from_rotvec(other).as_matrix(), np.empty((3, 3))
    between = np.array(turned_between(A, B, out))
    np.testing.assert_allclose(out, A @ B.T, rtol=0, atol=1e-12)
    np.testing.assert_allclose(Rotation.from_rotvec(between).as_matrix() @ B, A, rtol=0, atol=1e-12)
