"""How much larger than held what the model lacks is, as each sensor shows that is left out in turn."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.model import Arm
from tests.tracking.smoother.test_discrepancy_smoother import NOISE, RATE_HZ, Case, case
from tracking.model.observation import observation_of
from tracking.model.readings import ReadingsBuilder
from tracking.smoother.discrepancy_smoother import DiscrepancySmoother
from tracking.smoother.linearised import Linearised
from tracking.smoother.sensor_disagreement import disagreement, variance_by_lack
from tracking.smoother.smoothed import Smoothed

PLAY_RAD = 0.02


def with_play(arm: Arm, seed: int) -> Case:
    """Return readings of an arm whose last sensor is loose: it is turned by which way the last joint goes."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 12.0, 1.0 / RATE_HZ)
    since = np.maximum(t - 1.0, 0.0)[:, None]
    q = (1.0 - np.exp(-(since**3))) * 0.6 * np.sin(2.0 * np.pi * rng.uniform(0.3, 1.0, 2) * since)

    def felt(q: np.ndarray) -> np.ndarray:
        dq = np.gradient(q, t, axis=0)
        return specific_force(arm, q, dq, np.gradient(dq, t, axis=0)).reshape(len(t), -1)

    loose = q - [0.0, 0.5 * PLAY_RAD] * np.tanh(np.gradient(q, t, axis=0) / 0.1)
    readings = felt(q)
    readings[:, 9:] = felt(loose)[:, 9:]
    builder = ReadingsBuilder(RATE_HZ, readings.shape[1], RATE_HZ)
    builder.push(readings + NOISE * rng.standard_normal(readings.shape))
    return Case(builder.done(), q)


def smoothed(arm: Arm, one: Case) -> tuple[Smoothed, Linearised]:
    """Return what the smoother finds, and its last problem of readings, with the sizes that it found."""
    kept: list[Linearised] = []

    class Watched(DiscrepancySmoother):
        def _judged(self, fit):
            judged = super()._judged(fit)
            kept.append(judged.problem)
            return judged

    found = Watched(arm, one.q[0], True).smooth(one.readings)
    return found, kept[-1]


HOUSING = np.arange(4)


@pytest.fixture(scope="module")
def right(vertical_arm: Arm) -> Linearised:
    """Return the problem of readings that the model lacks something of at all sensors alike."""
    return smoothed(vertical_arm, case(vertical_arm, 1, lack=0.3))[1]


def test_where_the_model_is_right_sensors_agree(right: Linearised) -> None:
    ratio = disagreement(right, HOUSING)
    assert ratio.shape == (2,) and (ratio >= 1.0).all() and (ratio < 3.0).all()


def test_a_loose_sensor_disagrees_and_the_claim_holds_its_play(vertical_arm: Arm) -> None:
    """With what all sensors are held to lack alike, a quarter of the angles was off by more than was claimed."""
    one = with_play(vertical_arm, 0)
    found, problem = smoothed(vertical_arm, one)
    assert disagreement(problem, HOUSING)[1] > 3.0
    off = np.abs(found.states[:, :6:3] - one.q)
    assert np.mean(off < 3.0 * np.sqrt(found.variance[:, ::3])) > 0.95


def test_the_only_sensor_has_none_to_disagree_with(right: Linearised) -> None:
    np.testing.assert_array_equal(disagreement(right, np.zeros(4, dtype=np.intp)), 1.0)


def test_the_part_of_what_is_lacking_is_a_tangent(right: Linearised) -> None:
    """The variance of the best estimate is concave in the sizes, and what is lacking is a part of all."""
    problem = right
    part = variance_by_lack(problem)
    variance = problem.smoothed()[0].variance[:, :6]
    assert (part >= 0.0).all() and (part <= variance * (1.0 + 1e-6)).all()
    assert (part[:, ::3].mean(axis=0) > 0.1 * variance[:, ::3].mean(axis=0)).all()
    P0, lack = problem.P0.copy(), slice(problem.of.lack_column, problem.of.lack_column + 12)
    P0[lack, lack] *= 4.0
    larger = problem._replace(course=problem.course._replace(lack_std=2.0 * problem.course.lack_std), P0=P0)
    most = larger.smoothed()[0].variance[:, :6]
    assert (most <= (variance + 3.0 * part) * (1.0 + 1e-3)).all() and (most >= variance).all()


@pytest.mark.parametrize("known", [0, 3])
def test_a_gyroscope_is_left_out_with_its_accelerometer(vertical_arm: Arm, known: int) -> None:
    arm = vertical_arm.with_gyroscopes([vertical_arm.sensors[known].name])
    smoother = DiscrepancySmoother(arm, np.zeros(2), True)
    np.testing.assert_array_equal(smoother._housing, [0, 1, 2, 3, known])
    assert observation_of(replace(arm))[0].turning.sum() == 1
