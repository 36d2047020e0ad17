"""The 24 ways in which a sensor's axes can be exchanged against the file."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Joint, Sensor
from tracking.model.initial_state import MountingPrior
from tracking.model.noise import Noise
from tracking.model.readings import Readings
from tracking.smoother import orientations
from tracking.smoother.orientations import (
    _at_rest,
    _of_channels,
    _part,
    likely_orientations,
    log_likelihood,
    right_angles,
    turned,
)
from tracking.smoother.rough_motion import RATE_HZ, RoughMotion

NOTHING = np.zeros((0, 0))


def test_there_are_24_ways_and_they_are_a_group() -> None:
    ways = right_angles()
    assert len(ways) == 24
    np.testing.assert_array_equal(ways[0], np.eye(3))
    np.testing.assert_allclose(np.linalg.det(ways), 1.0)
    known = {tuple(R.ravel()) for R in ways}
    assert len(known) == 24 and {tuple((a @ b).ravel()) for a in ways for b in ways} == known


def way_of(file: Sensor, sensor: Sensor) -> int:
    """Return in which of the 24 ways a sensor is turned against the file."""
    R = rotation_from_rpy(*file.rotation_rad).T @ rotation_from_rpy(*sensor.rotation_rad)
    return int(np.argmin(np.abs(right_angles() - R).sum(axis=(1, 2))))


def test_ways_begin_with_those_that_turn_least() -> None:
    traces = np.trace(right_angles(), axis1=1, axis2=2)
    assert (np.diff(traces) <= 0.0).all() and traces[0] == 3.0 and traces[-1] == -1.0
    assert not right_angles().flags.writeable


@pytest.mark.parametrize("way", range(0, 24, 5))
def test_a_sensor_is_turned_in_its_own_axes(spatial, way) -> None:
    arm = turned(spatial, (0, way))
    for s, (sensor, before) in enumerate(zip(arm.sensors, spatial.sensors, strict=True)):
        R = rotation_from_rpy(*before.rotation_rad)
        expected = R @ right_angles()[way] if s == 1 else R
        np.testing.assert_allclose(rotation_from_rpy(*sensor.rotation_rad), expected, atol=1e-12)
        assert replace(sensor, rotation_rad=before.rotation_rad) == before


def test_twelve_seconds_of_some_accelerometers_are_looked_at(spatial) -> None:
    values = np.arange(1300.0 * 24).reshape(1300, 24)
    one = np.arange(24.0)
    readings = Readings(values, 0.01, 0.5, Noise(one, one + 100.0, one + 200.0), 4)
    some = _of_channels(readings, np.array([4, 1]))
    columns = [12, 13, 14, 3, 4, 5]
    np.testing.assert_array_equal(some.values, values[:1200, columns])
    for name in ("variance", "rounding", "least"):
        np.testing.assert_array_equal(getattr(some.noise, name), getattr(readings.noise, name)[columns])
    assert (some.dt_s, some.t0_s, some.factor) == (0.01, 0.5, 4)
    part = _part(spatial.with_gyroscopes(["s4"]), np.array([3, 0]))
    assert [sensor.name for sensor in part.sensors] == ["s4", "s1"]
    assert part.joints == spatial.joints[:2] and not part.gyroscopes and part.tip is None


@pytest.mark.parametrize(
    ("level", "turn", "kept"),
    [
        *((1.57, 0.0, {0, 90, 180}), (1.59, 0.0, {0, 90}), (2.23, 0.0, {0, 90}), (2.24, 0.0, {0})),
        *((2.23, 0.5, {0, 90, 180}), (2.24, 0.5, {0, 90}), (3.15, 0.5, {0, 90}), (3.17, 0.5, {0})),
    ],
)
def test_ways_that_gravity_contradicts_are_not_looked_at(level, turn, kept) -> None:
    """An offset of 0.5 m/s^2, and as much by a turn; squares in its unit may be forty more than the best has.

    By a quarter of a turn a level reading is missed by 2 of its squares, by half a turn by 4.
    """
    upright, sensor = np.sqrt(9.8**2 - level**2), Sensor("s1", 1, (0.1, 0.0, 0.0))
    arm = Arm("one", (Joint(a_m=0.3),), sensors=(sensor,), gravity_m_s2=(-level, 0.0, -upright))
    readings = SimpleNamespace(first_mean=np.array([level, 0.0, upright + 1.0]))
    prior, tries = MountingPrior(turn_rad=turn / 9.8), [(way,) for way in range(24)]
    ways = right_angles()[[way for (way,) in _at_rest(arm, readings, np.zeros(1), True, prior, tries)]]
    np.testing.assert_array_equal(ways[:, 2, 2], 1.0)
    assert set(np.degrees(np.arccos((np.trace(ways, axis1=1, axis2=2) - 1.0) / 2.0)).round()) == kept


class Liking:
    """Stands for rough motions: a sensor's way costs as much as a table says, and near are those it names."""

    def __init__(self, arm: Arm, near: object = lambda _ways: True) -> None:
        self._file, self._near = {sensor.name: sensor for sensor in arm.sensors}, near
        self.cost = {
            name: np.random.default_rng([7, k]).permutation(24).astype(float) for k, name in enumerate(self._file)
        }
        self.seen: list[tuple[tuple[str, ...], int, bool]] = []
        self.rates: list[float] = []
        self.near_from_hz = 0.0

    def __call__(self, arm, readings, q, given, prior=None, rate_hz=RATE_HZ) -> RoughMotion | None:
        assert readings.values.shape[1] == 3 * len(arm.sensors) and len(q) == arm.n_joint
        ways = {sensor.name: way_of(self._file[sensor.name], sensor) for sensor in arm.sensors}
        self.seen.append((tuple(ways), arm.n_joint, prior is not None))
        self.rates.append(rate_hz)
        likely = -sum(self.cost[name][way] for name, way in ways.items())
        return RoughMotion(NOTHING, 1, likely, rate_hz >= self.near_from_hz and self._near(ways))


@pytest.fixture
def few(spatial) -> Arm:
    """Three sensors, out of order: on the second, the third and the first link."""
    sensors = spatial.sensors
    return replace(spatial, sensors=(sensors[2], sensors[4], sensors[0]), tip=None)


def sought(few, monkeypatch, liking):
    said: list[int] = []
    readings = SimpleNamespace(begins_steadily=False, values=np.zeros((4, 9)), dt_s=0.001)
    monkeypatch.setattr(orientations, "rough_motion", liking)
    monkeypatch.setattr(
        orientations,
        "_of_channels",
        lambda some, taken: SimpleNamespace(
            begins_steadily=False, values=some.values[:, : 3 * len(taken)], dt_s=some.dt_s
        ),
    )
    found = likely_orientations(few, readings, np.arange(3.0), True, MountingPrior(), said.append)
    return found, said


def test_the_likeliest_ways_are_found_link_by_link(few, monkeypatch) -> None:
    liking = Liking(few)
    found, said = sought(few, monkeypatch, liking)
    best = tuple(int(np.argmin(liking.cost[sensor.name])) for sensor in few.sensors)
    assert found[0].ways == best and found[0].log_likelihood == 0.0
    likely = [one.log_likelihood for one in found]
    # Of independent costs 0, 1, 2, ... the eight least sums of three.
    assert likely == sorted(likely, reverse=True) == [0.0, -1.0, -1.0, -1.0, -2.0, -2.0, -2.0, -2.0]
    assert said == [24, 24 + 8 * 24, 24 + 2 * 8 * 24]
    assert liking.seen[0] == (("s1",), 1, False)
    assert liking.seen[24] == (("s1", "s3"), 2, False) and liking.seen[216] == (("s1", "s3", "s5"), 3, False)
    assert [prior for *_, prior in liking.seen] == [False] * said[-1] + [True] * 8


def test_what_only_long_frames_have_far_away_is_near(few, monkeypatch) -> None:
    """In readings of 1 kHz, of which four are one frame of the smoother's first passes."""
    liking = Liking(few)
    liking.near_from_hz = 4.0 * RATE_HZ
    found, said = sought(few, monkeypatch, liking)
    assert len(said) == 3  # nothing is sought a second time
    likely = [one for one in found if one.log_likelihood > -np.log(100.0)]
    assert all(one.is_near for one in likely) and found[0].log_likelihood == 0.0
    assert liking.rates[said[-1] + 8 :] == [2.0 * RATE_HZ, 4.0 * RATE_HZ] * len(likely)


def test_what_stays_far_is_asked_down_to_the_smoothers_own_frames(few, monkeypatch) -> None:
    liking = Liking(few, lambda _ways: False)
    found, _ = sought(few, monkeypatch, liking)
    assert not found[0].is_near and max(liking.rates) == pytest.approx(250.0)


def test_where_none_is_near_more_are_kept(few, monkeypatch) -> None:
    found, said = sought(few, monkeypatch, Liking(few, lambda _ways: False))
    assert len(found) == 32 and not any(one.is_near for one in found)
    assert said[3:] == [24, 24 + 24 * 24, 24 + 24 * 24 + 32 * 24]


def test_what_is_near_comes_before_what_is_likelier(few, monkeypatch) -> None:
    liking = Liking(few)
    liking._near = lambda ways: "s5" in ways and liking.cost["s5"][ways["s5"]] == 1.0
    found, _ = sought(few, monkeypatch, liking)
    assert [one.is_near for one in found] == sorted((one.is_near for one in found), reverse=True)
    assert found[0].is_near and found[0].log_likelihood == -1.0
    assert not found[-1].is_near and max(one.log_likelihood for one in found if not one.is_near) == 0.0


@pytest.mark.parametrize(("given", "expected"), [(True, 0.0), (False, -0.5 * (0.1**2 + 0.2**2 + 1.0**2))])
def test_first_angles_that_are_not_given_are_likelier_near_the_zero(few, monkeypatch, given, expected) -> None:
    """But for whole turns; the standard deviation of a guess is 1 rad."""
    states = np.zeros((4, 12))
    states[0, :9:3] = 0.1, 2.0 * np.pi - 0.2, 1.0
    monkeypatch.setattr(orientations, "rough_motion", lambda *_: RoughMotion(states, 1, -5.0, True))
    found = orientations._log_likelihood(few, None, np.zeros(3), given, None)
    assert found == (-5.0, True, pytest.approx(expected))


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        (RoughMotion(NOTHING, 1, -5.0, True), -5.0),
        (RoughMotion(NOTHING, 1, -5.0, False), -np.inf),
        (None, -np.inf),
    ],
)
def test_only_an_arm_that_is_near_is_likely(few, monkeypatch, motion, expected) -> None:
    monkeypatch.setattr(orientations, "rough_motion", lambda *_: motion)
    readings = Readings(np.zeros((4, 9)), 0.01, 0.0, Noise(np.ones(9), np.ones(9)), 1)
    assert log_likelihood(few, readings, np.zeros(3), True, MountingPrior()) == expected
