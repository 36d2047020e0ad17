"""How sensors are mounted: as their file says, or turned where that is a hundred times likelier."""

from dataclasses import replace

import numpy as np
import pytest

from arm.kinematics import rotation_from_rpy
from arm.model import Arm
from tests.tracking.model.test_clocks import felt, read
from tracking.model.initial_state import ROUGH, MountingPrior
from tracking.smoother import mounting_search
from tracking.smoother.mounting_search import Mounting, axes_of, likely_mounting
from tracking.smoother.orientations import Turned, right_angles, turned


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


def judged(monkeypatch: pytest.MonkeyPatch, arm: Arm, as_told: float, *ways: Turned) -> Mounting:
    """Return how sensors are mounted if the file and turned sensors are so likely."""
    monkeypatch.setattr(mounting_search, "likely_orientations", lambda *_: list(ways))
    monkeypatch.setattr(mounting_search, "log_likelihood", lambda *_: as_told)
    return likely_mounting(arm, None, np.zeros(2), True, MountingPrior())


@pytest.mark.parametrize(("odds", "as_file"), [(99.0, True), (101.0, False)])
def test_the_file_holds_up_to_a_hundred_to_one(
    monkeypatch: pytest.MonkeyPatch, dd_arm: Arm, odds: float, as_file: bool
) -> None:
    found = judged(monkeypatch, dd_arm, -np.log(odds), Turned((0, 5, 0, 0), 0.0, True))
    assert (found.arm == dd_arm) == as_file
    assert found.axes == ({} if as_file else {"s2": axes_of(5)})


def test_nothing_likely_leaves_the_file(monkeypatch: pytest.MonkeyPatch, dd_arm: Arm) -> None:
    found = judged(monkeypatch, dd_arm, -np.inf, Turned((3, 3, 3, 3), -np.inf, True))
    assert (found.arm, found.axes) == (dd_arm, {})


def test_of_equals_that_turn_as_many_the_likelier_first_angles_are_taken(
    monkeypatch: pytest.MonkeyPatch, dd_arm: Arm
) -> None:
    """An upright flat arm reads the same from behind, where it hangs on the other side."""
    behind, before = Turned((5, 7, 0, 0), 0.0, True, -4.9), Turned((9, 7, 0, 0), -0.1, True, -0.3)
    assert judged(monkeypatch, dd_arm, -50.0, behind, before).arm == turned(dd_arm, (9, 7, 0, 0))
    assert judged(monkeypatch, dd_arm, -50.0, behind._replace(ways=(5, 0, 0, 0)), before).axes == {
        "s1": axes_of(5)
    }


def test_of_equals_that_nearest_the_file_is_taken_and_others_told(
    monkeypatch: pytest.MonkeyPatch, dd_arm: Arm
) -> None:
    ways = (
        Turned((5, 7, 0, 0), 0.0, True),
        Turned((5, 0, 0, 0), -4.0, True),
        Turned((0, 0, 0, 0), -5.0, True),  # beyond a hundred to one
        Turned((0, 0, 0, 9), -1.0, False),  # and far away
    )
    found = judged(monkeypatch, dd_arm, -50.0, *ways)
    assert found.axes == {"s1": axes_of(5)} and found.prior == ROUGH
    assert found.arm == turned(dd_arm, (5, 0, 0, 0)) and found.is_found
    assert found.undecided == [f"equally likely are the axes s2 {axes_of(7)}"]


def test_where_none_is_near_the_file_is_kept(monkeypatch: pytest.MonkeyPatch, dd_arm: Arm) -> None:
    """A walker's sensors were turned by 90 degrees, for what a base that moves does to the readings."""
    ways = Turned((5, 7, 0, 0), 0.0, False), Turned((5, 0, 0, 0), -1.0, False)
    found = judged(monkeypatch, dd_arm, -50.0, *ways)
    assert (found.arm, found.prior, found.axes, found.is_found) == (dd_arm, MountingPrior(), {}, False)
    assert (
        len(found.undecided) == 1 and "whether axes are exchanged or reversed does not show" in found.undecided[0]
    )
