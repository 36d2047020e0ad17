"""What is said of sensors' numbers: values, what a motion showed, and what it showed only together."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from arm.model import Gyroscope
from tracking.model.observation import observation_of
from tracking.smoother.sensor_estimates import clock_estimates, covariance_of, estimates_of, hidden_of


@pytest.fixture
def before(dd_arm):
    of, size = observation_of(dd_arm, mountings=True)
    return of, np.diag(np.full(size, 0.04**2))


def known(covariance, **columns):
    return SimpleNamespace(final=np.zeros(len(covariance)), covariance=covariance, clocks=None, **columns)


def test_a_number_is_revealed_where_its_error_has_halved(dd_arm, before):
    of, prior = before
    covariance = prior.copy()
    column = int(of.mounting_column[1]) + 6
    covariance[column, column] = 0.019**2
    after = known(covariance)
    after.final[column] = 0.05
    found = {(one.sensor, one.name): one for one in estimates_of(dd_arm, of, after, prior)}
    assert [key for key, one in found.items() if one.revealed] == [(dd_arm.sensors[1].name, "place_x")]
    one = found[dd_arm.sensors[1].name, "place_x"]
    assert (one.value, one.std, one.unit) == pytest.approx((0.05, 0.019, "m"))


def test_scales_are_counted_from_the_files(dd_arm, before):
    of, prior = before
    scales = [one for one in estimates_of(dd_arm, of, known(prior), prior) if one.name.startswith("scale")]
    assert [one.value for one in scales] == pytest.approx(np.ravel([sensor.scale for sensor in dd_arm.sensors]))


def test_what_no_reading_touched_does_not_show(dd_arm, before):
    of, prior = before
    said = hidden_of(dd_arm, of, known(prior), prior)
    assert len(said) == 12 * len(dd_arm.sensors)
    assert f"{dd_arm.sensors[0].name} bias_x does not show" in said


def test_two_numbers_of_which_the_difference_alone_is_known_do_not_show_together(dd_arm, before):
    of, prior = before
    covariance = np.diag(np.full(len(prior), 1e-6))
    a, b = int(of.mounting_column[0]) + 6, int(of.mounting_column[1]) + 6
    together = np.zeros(len(prior))
    together[[a, b]] = np.sqrt(0.5)
    covariance += 0.04**2 * np.outer(together, together)
    names = [sensor.name for sensor in dd_arm.sensors]
    (sentence,) = hidden_of(dd_arm, of, known(covariance), prior)
    assert sentence == f"these do not show together: {names[0]} place_x + {names[1]} place_x"


def test_the_covariance_has_a_row_for_each_estimate(dd_arm, before):
    of, prior = before
    covariance = covariance_of(dd_arm, of, known(prior))
    estimates = estimates_of(dd_arm, of, known(prior), prior)
    assert covariance.parameters == tuple(f"{one.sensor} {one.name}" for one in estimates)
    assert [len(row) for row in covariance.covariance] == list(range(1, len(estimates) + 1))
    assert [row[-1] for row in covariance.covariance] == pytest.approx([one.std**2 for one in estimates])


def test_clocks_are_those_of_the_other_sensors(dd_arm, before):
    _, prior = before
    late = np.array([0.0, 0.02, -0.005, 0.0])
    after = known(prior)
    assert clock_estimates(dd_arm, after) == []
    after.clocks = SimpleNamespace(late_s=late, std_s=np.full(4, 1e-4))
    found = clock_estimates(dd_arm, after)
    assert [one.sensor for one in found] == [sensor.name for sensor in dd_arm.sensors[1:]]
    assert [one.value for one in found] == pytest.approx(late[1:])
    assert all(one.revealed and one.unit == "s" for one in found)


def test_ac_coupled_sensors_and_gyroscopes_have_numbers_of_their_own(dd_arm):
    """An offset is what a sensor settles at, a corner in Hz; a gyroscope's scale is counted from its file's."""
    first, second, *others = dd_arm.sensors
    turning = replace(second, gyroscope=Gyroscope(scale=(1.5, 2.0, 2.5)))
    arm = replace(dd_arm, sensors=(replace(first, highpass_hz=0.5), turning, *others))
    of, size = observation_of(arm, mountings=True)
    prior = np.eye(size)
    after = known(prior.copy())
    own = of.settled_column, of.corner_column, of.gyro_scale_column
    settled, corner, scale = (int(columns.max()) for columns in own)
    after.final[settled : settled + 3] = [0.1, 0.2, 0.3]
    after.final[corner], after.covariance[corner, corner] = 2.0 * np.pi * 0.1, (2.0 * np.pi * 0.02) ** 2
    after.final[scale + 1] = 0.01
    bias = 3 * arm.n_joint + 3 * len(arm.sensors)
    after.final[bias : bias + 3] = [4.0, 5.0, 6.0]
    found = {(one.sensor, one.name): one for one in estimates_of(arm, of, after, prior)}
    expected = {
        **{(first.name, f"bias_{axis}"): (0.1 * (k + 1), 1.0, "m/s^2") for k, axis in enumerate("xyz")},
        (first.name, "highpass_hz"): (0.6, 0.02, "Hz"),
        **{(second.name, f"gyro_bias_{axis}"): (4.0 + k, 1.0, "rad/s") for k, axis in enumerate("xyz")},
        **{
            (second.name, f"gyro_scale_{axis}"): (value, 1.0, "1")
            for axis, value in zip("xyz", (1.5, 2.01, 2.5), strict=True)
        },
        (others[0].name, "bias_x"): (0.0, 1.0, "m/s^2"),
        (others[0].name, "turn_z"): (0.0, 1.0, "rad"),
    }
    for key, said in expected.items():
        assert (found[key].value, found[key].std, found[key].unit) == pytest.approx(said), key
    assert len(found) == 12 * len(arm.sensors) + 1 + 6
    assert [key for key, one in found.items() if one.revealed] == [(first.name, "highpass_hz")]
    assert len(covariance_of(arm, of, after).parameters) == len(found) - 1  # a corner is of no use to it


def test_of_a_combination_the_parts_that_count_are_named_with_their_signs(dd_arm, before):
    of, prior = before
    places = [int(of.mounting_column[s]) + 6 for s in range(4)]
    names = [sensor.name for sensor in dd_arm.sensors]
    along = np.zeros(len(prior))
    along[places] = [0.80, -0.45, 0.36, 0.167]
    covariance = np.diag(np.full(len(prior), 1e-6)) + 0.04**2 * np.outer(along, along) / (along @ along)
    (sentence,) = hidden_of(dd_arm, of, known(covariance), prior)
    assert sentence == f"these do not show together: {names[0]} place_x - {names[1]} place_x + {names[2]} place_x"
    known_better = np.diag(np.full(len(prior), 1e-6)) + 0.019**2 * np.outer(along, along) / (along @ along)
    assert hidden_of(dd_arm, of, known(known_better), prior) == []
