"""What a calibration says of its numbers, by a smoother whose words the test puts into its mouth."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from arm.arm_file import load_arm
from arm.kinematics import rotation_from_rpy
from arm.model import Arm, SensorCovariance
from tracking.model.initial_state import MountingPrior
from tracking.model.observation import observation_of
from tracking.smoother import explained_runs
from tracking.smoother.self_calibration import SensorCalibration, calibrate_sensors

ARM = load_arm("dd-arm")
AC = replace(ARM, sensors=(replace(ARM.sensors[0], highpass_hz=0.2), *ARM.sensors[1:]))
PRIOR = MountingPrior()
EXACT = {"is_exact": True, "discrepancy": None, "clocks": None}


class Told:
    """Stands for the smoother: notes what it is asked, and tells what it was given, run by run."""

    def __init__(self, arm: Arm, *runs: SimpleNamespace) -> None:
        self.observation, self.size = observation_of(arm, True)
        self.runs, self.asked, self.made = list(runs), [], ()

    def __call__(self, *made: object) -> "Told":
        self.made = made
        return self

    def smooth(self, readings: object, **more: object) -> SimpleNamespace:
        self.asked.append((readings, more))
        return self.runs[len(self.asked) - 1]


def known(size: int, **fields: object) -> SimpleNamespace:
    plain = {"final": np.zeros(size), "covariance": 1e-6 * np.eye(size), "before": np.eye(size)}
    return SimpleNamespace(**{**plain, "doubted": 0.0, "passes": 1, "converged": True, **EXACT, **fields})


def calibrated(monkeypatch: pytest.MonkeyPatch, arm: Arm, **fields: object) -> tuple[SensorCalibration, Told]:
    told = Told(arm)
    told.runs.append(known(told.size, **fields))
    monkeypatch.setattr(explained_runs, "Smoother", told)
    return calibrate_sensors(arm, [readings(100)], np.zeros(2), PRIOR), told


def readings(n: int) -> SimpleNamespace:
    return SimpleNamespace(values=np.zeros((n, 12)))


def sizes(arm: Arm) -> tuple[object, int]:
    return observation_of(arm, True)


def test_numbers_are_those_of_the_state(monkeypatch: pytest.MonkeyPatch) -> None:
    of, size = sizes(ARM)
    final, std = 1e-3 * np.arange(size), 1e-2 * (1.0 + np.arange(size))
    found, _ = calibrated(monkeypatch, ARM, final=final, covariance=np.diag(std**2), before=1e4 * np.eye(size))
    assert len(found.estimates) == 4 * 12
    estimates = iter(found.estimates)
    for s, sensor in enumerate(ARM.sensors):
        first = int(of.mounting_column[s])
        for kind, unit, column, nominal in (
            ("bias", "m/s^2", 6 + 3 * s, 0.0),
            ("scale", "1", first, 1.0),
            ("turn", "rad", first + 3, 0.0),
            ("place", "m", first + 6, 0.0),
        ):
            for k, axis in enumerate("xyz"):
                one = next(estimates)
                assert (one.sensor, one.name, one.unit) == (sensor.name, f"{kind}_{axis}", unit)
                assert (one.value, one.std) == pytest.approx((nominal + final[column + k], std[column + k]))
                assert one.revealed is True


def test_sensors_are_put_where_they_were_found(monkeypatch: pytest.MonkeyPatch) -> None:
    arm = replace(ARM, sensors=(replace(ARM.sensors[0], rotation_rad=(0.1, -0.2, 0.3)), *ARM.sensors[1:]))
    of, size = sizes(arm)
    final = 0.3 * np.random.default_rng(0).normal(size=size)
    final[of.mounting_column[3] : of.mounting_column[3] + 9] = 0.0  # one that is as it was said to be
    found, _ = calibrated(monkeypatch, arm, final=final)
    for s, (said, sensor) in enumerate(zip(arm.sensors, found.arm.sensors, strict=True)):
        scale, turn, place = final[of.mounting_column[s] : of.mounting_column[s] + 9].reshape(3, 3)
        assert (sensor.name, sensor.joint, sensor.highpass_hz) == (said.name, said.joint, 0.0)
        assert sensor.position_m == pytest.approx(np.add(said.position_m, place))
        assert sensor.scale == pytest.approx(1.0 + scale)
        assert sensor.bias_m_s2 == pytest.approx(final[6 + 3 * s : 9 + 3 * s])
        turned = rotation_from_rpy(*said.rotation_rad) @ Rotation.from_rotvec(turn).as_matrix()
        np.testing.assert_allclose(rotation_from_rpy(*sensor.rotation_rad), turned, atol=1e-12)
    a = int(of.length_column[0, 0])
    assert found.arm.joints[0].a_m == pytest.approx(arm.joints[0].a_m + final[a])
    assert found.arm.joints[1].a_m == arm.joints[1].a_m  # its far end moves no sensor


def test_an_ac_coupled_sensor_settles_at_its_bias_and_has_a_corner(monkeypatch: pytest.MonkeyPatch) -> None:
    of, size = sizes(AC)
    final, std = 1e-3 * np.arange(size), 1e-2 * (1.0 + np.arange(size))
    covariance = np.diag(std**2)
    found, _ = calibrated(monkeypatch, AC, final=final, covariance=covariance, before=1e4 * np.eye(size))
    assert len(found.estimates) == 4 * 12 + 1
    settled, corner = int(of.settled_column[0]), int(of.corner_column[0])
    assert [one.value for one in found.estimates[:3]] == pytest.approx(final[settled : settled + 3])
    last = found.estimates[12]
    assert (last.sensor, last.name, last.unit) == ("s1", "highpass_hz", "Hz")
    assert last.value == pytest.approx(0.2 + final[corner] / (2.0 * np.pi))
    assert last.std == pytest.approx(std[corner] / (2.0 * np.pi))
    sensor = found.arm.sensors[0]
    assert sensor.bias_m_s2 == pytest.approx(final[settled : settled + 3])
    assert sensor.highpass_hz == pytest.approx(last.value)
    assert found.arm.sensors[1].bias_m_s2 == pytest.approx(final[9:12])
    assert found.arm.sensor_covariance is not None
    assert len(found.arm.sensor_covariance.parameters) == 48  # and the corner is left out


def test_how_well_they_are_known_together_goes_into_the_arm(monkeypatch: pytest.MonkeyPatch) -> None:
    of, size = sizes(ARM)
    root = np.random.default_rng(1).normal(size=(size, size))
    covariance = root @ root.T
    found, _ = calibrated(monkeypatch, ARM, covariance=covariance, before=1e4 * np.eye(size))
    known_now = found.arm.sensor_covariance
    assert known_now is not None
    assert known_now.parameters[:4] == ("s1 bias_x", "s1 bias_y", "s1 bias_z", "s1 scale_x")
    assert known_now.parameters[-1] == "s4 place_z"
    columns = [
        column
        for s in range(4)
        for column in (*range(6 + 3 * s, 9 + 3 * s), *(int(of.mounting_column[s]) + np.arange(9)).tolist())
    ]
    np.testing.assert_allclose(known_now.matrix(), covariance[np.ix_(columns, columns)])


@pytest.mark.parametrize(("share", "revealed"), [(0.49, True), (0.5, True), (0.51, False)])
def test_half_the_doubt_reveals_a_number(monkeypatch: pytest.MonkeyPatch, share: float, revealed: bool) -> None:
    size = sizes(ARM)[1]
    found, _ = calibrated(monkeypatch, ARM, covariance=4.0 * share**2 * np.eye(size), before=4.0 * np.eye(size))
    assert {one.revealed for one in found.estimates} == {revealed}
    said = [f"{one.sensor} {one.name} does not show" for one in found.estimates]
    assert sorted(found.hidden) == ([] if revealed else sorted(said))


def hidden(monkeypatch: pytest.MonkeyPatch, *combinations: tuple[float, dict[int, float]]) -> list[str]:
    """Return what is said of the scales where combinations of them keep a share of what was held of them."""
    of, size = sizes(ARM)
    scales = [int(of.mounting_column[s]) + k for s in range(4) for k in range(3)]
    held = 3.0 ** (np.arange(size) % 3)  # in whatever units they are
    covariance = 1e-4 * np.eye(size)
    for share, parts in combinations:
        along = np.zeros(size)
        for k, part in parts.items():
            along[scales[k]] = part
        along /= np.linalg.norm(along)
        covariance += share * np.outer(along, along)
    found, _ = calibrated(monkeypatch, ARM, covariance=covariance * np.outer(held, held), before=np.diag(held**2))
    return found.hidden


def test_what_does_not_show_together_is_told_with_its_signs(monkeypatch: pytest.MonkeyPatch) -> None:
    assert hidden(monkeypatch, (0.8, {0: 1.0, 1: 0.9})) == ["these do not show together: s1 scale_x + s1 scale_y"]
    assert hidden(monkeypatch, (0.8, {3: -1.0, 7: 0.9})) == ["these do not show together: s2 scale_x - s3 scale_y"]
    assert hidden(monkeypatch, (0.8, {0: 0.8, 1: 1.0, 11: -0.9})) == [
        "these do not show together: s1 scale_y - s4 scale_z + s1 scale_x"
    ]


@pytest.mark.parametrize(("part", "named"), [(0.34, False), (0.36, True)])
def test_small_parts_of_a_combination_are_not_told(
    monkeypatch: pytest.MonkeyPatch, part: float, named: bool
) -> None:
    rest = np.sqrt((1.0 - part**2) / 2.0)
    (said,) = hidden(monkeypatch, (0.8, {0: rest, 1: 0.999 * rest, 2: part}))
    assert ("s1 scale_z" in said) == named and "s1 scale_x + s1 scale_y" in said


def test_a_combination_of_many_small_parts_is_told_by_its_largest(monkeypatch: pytest.MonkeyPatch) -> None:
    (said,) = hidden(monkeypatch, (0.8, {k: 1.0 + 0.01 * (k == 5) for k in range(12)}))
    assert said == "s2 scale_z does not show"


@pytest.mark.parametrize(("share", "told"), [(0.24, 0), (0.26, 1)])
def test_a_quarter_of_the_variance_is_shown(monkeypatch: pytest.MonkeyPatch, share: float, told: int) -> None:
    assert len(hidden(monkeypatch, (share, {0: 1.0, 1: 1.0}))) == told


def test_what_shows_least_is_told_first(monkeypatch: pytest.MonkeyPatch) -> None:
    said = hidden(monkeypatch, (0.4, {0: 1.0, 1: 0.9}), (0.8, {4: 1.0, 5: 0.9}), (0.95, {7: 1.0}))
    assert said == [
        "s3 scale_y does not show",  # as little is known as before
        "these do not show together: s2 scale_y + s2 scale_z",
        "these do not show together: s1 scale_x + s1 scale_y",
    ]


def test_runs_are_summed_up(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(ARM)
    first = known(told.size, doubted=0.1, passes=3, before=4.0 * np.eye(told.size))
    second = known(told.size, doubted=0.2, passes=4, converged=False, final=np.ones(told.size))
    told.runs = [first, second]
    monkeypatch.setattr(explained_runs, "Smoother", told)
    runs, progress = [readings(100), readings(300)], [].append
    known_before = SensorCovariance(("s1 scale_x",), ((4.0,),))
    found = calibrate_sensors(replace(ARM, sensor_covariance=known_before), runs, None, PRIOR, progress)
    assert (found.passes, found.converged, found.doubted) == (7, False, pytest.approx(0.175))
    assert found.estimates[0].value == 1.0  # of the last
    assert [one for one, _ in told.asked] == runs
    assert [more for _, more in told.asked] == [
        {"fine": False, "known": None, "progress": progress, "explaining": True},
        {"fine": False, "known": first, "progress": progress, "explaining": True},
    ]
    arm, q0, given, prior, clocks = told.made
    assert (arm, q0.tolist(), given, prior, clocks) == (
        ARM,
        [0.0, 0.0],
        False,
        PRIOR,
        False,
    )  # what was known is found anew
    told.asked.clear()
    calibrate_sensors(ARM, runs, np.array([0.1, 0.2]), PRIOR)
    assert (told.made[1].tolist(), told.made[2]) == ([0.1, 0.2], True)
