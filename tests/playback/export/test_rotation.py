"""Quaternions against SciPy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from playback.export.rotation import quaternion_between, quaternions

part = st.floats(-1.0, 1.0)
four = st.tuples(part, part, part, part).filter(lambda q: np.linalg.norm(q) > 0.1)


@given(st.lists(four, min_size=1, max_size=8))
def test_they_are_the_rotations(parts: list[tuple[float, float, float, float]]) -> None:
    R = Rotation.from_quat(parts).as_matrix()
    q = quaternions(R)
    assert np.linalg.norm(q, axis=1) == pytest.approx(1.0)
    assert Rotation.from_quat(q).as_matrix() == pytest.approx(R, abs=1e-12)
    assert np.all(np.sum(q[1:] * q[:-1], axis=1) >= 0.0)


def test_the_sign_goes_on_through_several_turns() -> None:
    angle = np.linspace(0.0, 20.0, 200)
    q = quaternions(Rotation.from_rotvec(np.outer(angle, [0.0, 0.6, 0.8])).as_matrix())
    assert q[:, 3] == pytest.approx(np.cos(angle / 2), abs=1e-12)


direction = st.tuples(part, part, part).filter(lambda v: np.linalg.norm(v) > 0.1)


@given(direction, direction)
def test_one_direction_is_turned_into_another(a: tuple[float, ...], b: tuple[float, ...]) -> None:
    start, end = np.array(a) / np.linalg.norm(a), np.array(b) / np.linalg.norm(b)
    for goal in (end, -start):
        assert Rotation.from_quat(quaternion_between(start, goal)).apply(start) == pytest.approx(goal, abs=1e-6)
