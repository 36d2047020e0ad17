"""Sensors whose axes are exchanged against the file: the 24 ways, and which of them readings show."""

from dataclasses import replace

import numpy as np
import pytest

from arm.kinematics import rotation_from_rpy
from arm.model import Arm
from tests.tracking.model.test_clocks import felt, read
from tracking.model.initial_state import ROUGH, MountingPrior
from tracking.smoother.mounting_search import axes_of, likely_mounting
from tracking.smoother.orientations import right_angles, turned


def test_there_are_24_ways_and_they_are_a_group() -> None:
    ways = right_angles()
    assert len(ways) == 24
    np.testing.assert_array_equal(ways[0], np.eye(3))
    np.testing.assert_allclose(np.linalg.det(ways), 1.0)
    known = {tuple(R.ravel()) for R in ways}
    assert len(known) == 24 and {tuple((a @ b).ravel()) for a in ways for b in ways} == known


@pytest.mark.parametrize("way", range(24))
def test_axes_are_told_by_their_letters(way: int, dd_arm: Arm) -> None:
    R = rotation_from_rpy(*turned(dd_arm, (way,)).sensors[0].rotation_rad)
    R = rotation_from_rpy(*dd_arm.sensors[0].rotation_rad).T @ R
    for k, axis in enumerate(axes_of(way).split()):
        assert R["xyz".index(axis[-1]), k] == pytest.approx(-1.0 if axis[0] == "-" else 1.0)


def garbled(arm: Arm, ways: tuple[int, ...], share: tuple[float, ...]) -> tuple[Arm, tuple[int, ...]]:
    """Return a file that is wrong by these ways, and the ways that put it right; places are wrong by shares."""
    R = right_angles()
    back = tuple(int(np.argmin([np.abs(R[way].T - other).sum() for other in R])) for way in ways)
    wrong = turned(arm, back)
    sensors = [
        replace(s, position_m=tuple((np.array(s.position_m) * part).tolist()))
        for s, part in zip(wrong.sensors, share, strict=True)
    ]
    joints = (replace(arm.joints[0], a_m=1.2 * arm.joints[0].a_m), *arm.joints[1:])
    return replace(wrong, sensors=tuple(sensors), joints=joints), ways


def test_exchanged_axes_are_found_from_wrong_places_and_lengths(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    wrong, ways = garbled(vertical_arm, (5, 0, 17, 9), (1.25, 0.8, 0.75, 1.2))
    found = likely_mounting(wrong, read(readings), q[0], True, MountingPrior())
    assert found.prior == ROUGH and found.undecided == []
    assert set(found.axes) == {s.name for s, way in zip(wrong.sensors, ways, strict=True) if way}
    for true, sensor in zip(vertical_arm.sensors, found.arm.sensors, strict=True):
        np.testing.assert_allclose(
            rotation_from_rpy(*sensor.rotation_rad), rotation_from_rpy(*true.rotation_rad), atol=1e-9
        )


def test_sensors_that_are_as_their_file_says_are_left(vertical_arm: Arm) -> None:
    readings, q = felt(vertical_arm, 0.0, 5.0)
    found = likely_mounting(vertical_arm, read(readings), q[0], True, MountingPrior())
    assert (found.arm, found.prior, found.axes) == (vertical_arm, MountingPrior(), {})
