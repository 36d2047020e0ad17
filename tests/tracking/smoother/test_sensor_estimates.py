"""What is said of sensors' numbers: values, what a motion showed, and what it showed only together."""

from types import SimpleNamespace

import numpy as np
import pytest

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
