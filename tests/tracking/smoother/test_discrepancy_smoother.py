"""An arm that is not quite the one in its file, on a base that may move: angles, claims, what is found of it."""

from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.kinematics import axis_frames, rotation_from_rpy
from arm.model import Arm
from tracking.model.initial_state import MountingPrior
from tracking.model.readings import Readings, ReadingsBuilder
from tracking.smoother.discrepancy_smoother import DiscrepancySmoother, _rest_at_every_frame
from tracking.smoother.smoothed_frames import most_probable

RATE_HZ, SECONDS, REST_S, NOISE = 100.0, 6.0, 1.0, 0.02


class Case(NamedTuple):
    """Readings, and the angles that they are of."""

    readings: Readings
    q: np.ndarray


def coloured(rng: np.random.Generator, std: float, memory_s: float, shape: tuple[int, ...]) -> np.ndarray:
    """Return draws of an Ornstein-Uhlenbeck process along the first axis."""
    kept = np.exp(-1.0 / (RATE_HZ * memory_s))
    x = std * rng.standard_normal(shape)
    for k in range(1, len(x)):
        x[k] = kept * x[k - 1] + np.sqrt(1.0 - kept**2) * x[k]
    return x


def case(arm: Arm, seed: int, base: float = 0.0, lack: float = 0.0, seconds: float = SECONDS) -> Case:
    """Return readings of an arm that rests and then swings, on a base that moves, with errors of its model."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, seconds, 1.0 / RATE_HZ)
    turns = 2.0 * np.pi * rng.uniform(0.3, 1.0, 2)
    since = np.maximum(t - REST_S, 0.0)[:, None]
    gone = 1.0 - np.exp(-(since**3))  # smooth to the acceleration
    q = gone * 0.6 * np.sin(turns * since)
    dq, ddq = np.gradient(q, t, axis=0), np.gradient(np.gradient(q, t, axis=0), t, axis=0)
    felt = specific_force(arm, q, dq, ddq).reshape(len(t), -1)
    moved = coloured(rng, base, 0.1, (len(t), 3)) if base else np.zeros((len(t), 3))
    frames = axis_frames(arm, q)
    for s, sensor in enumerate(arm.sensors):
        R = frames[:, sensor.joint - 1, :3, :3] @ rotation_from_rpy(*sensor.rotation_rad)
        felt[:, 3 * s : 3 * s + 3] += np.einsum("kij,ki->kj", R, moved)
    if lack:
        felt += coloured(rng, lack, 0.1, felt.shape)
    builder = ReadingsBuilder(RATE_HZ, felt.shape[1], RATE_HZ)
    builder.push(felt + NOISE * rng.standard_normal(felt.shape))
    return Case(builder.done(), q)


def within_3_std(found, q: np.ndarray) -> float:
    n = q.shape[1]
    off = np.abs(found.states[:, : 3 * n : 3] - q)
    return float(np.mean(off < 3.0 * np.sqrt(found.variance[:, ::3])))


def test_an_arm_that_is_as_its_file_says_is_left_to_the_plain_smoother(vertical_arm: Arm) -> None:
    one = case(vertical_arm, 0)
    found = most_probable(vertical_arm, one.readings, np.zeros(2), True)
    assert found.discrepancy is None and found.is_exact


def test_what_the_model_lacks_is_learnt_and_claimed(vertical_arm: Arm) -> None:
    one = case(vertical_arm, 1, lack=0.3)
    found = most_probable(vertical_arm, one.readings, np.zeros(2), True)
    assert found.discrepancy is not None and found.discrepancy.base_std == 0.0
    assert found.discrepancy.lack_std == pytest.approx(0.3, rel=0.3)
    assert within_3_std(found, one.q) > 0.97


def test_a_base_that_moves_is_told_from_sensors_that_err(vertical_arm: Arm) -> None:
    one = case(vertical_arm, 2, base=1.0, lack=0.05, seconds=4.0)
    found = most_probable(vertical_arm, one.readings, np.zeros(2), True)
    assert found.discrepancy is not None
    assert found.discrepancy.base_std == pytest.approx(1.0, rel=0.4)
    assert found.discrepancy.lack_std < 0.3
    assert within_3_std(found, one.q) > 0.97


def test_no_gain_stands_for_a_base_that_rocks(vertical_arm: Arm) -> None:
    """Across the plane the second link is moved twice as far as the first; all four sensors have no gain."""
    one, rng = case(vertical_arm, 3, lack=0.05, seconds=4.0), np.random.default_rng(4)
    sideways = coloured(rng, 0.5, 0.1, (len(one.readings.values), 1))
    moved = one.readings.values.copy()
    moved[:, 2::3] += sideways * [sensor.joint for sensor in vertical_arm.sensors]
    smoother = DiscrepancySmoother(vertical_arm, np.zeros(2), True, MountingPrior())
    found = smoother.smooth(replace(one.readings, values=moved))
    assert found.discrepancy is not None and found.discrepancy.base_std > 0.1
    gains = found.final[smoother.observation.mounting_column[:, None] + np.arange(3)]
    assert np.abs(gains).max() < 3.0 * MountingPrior().scale


def test_what_an_earlier_recording_showed_is_known(vertical_arm: Arm) -> None:
    smoother, told = DiscrepancySmoother(vertical_arm, np.zeros(2), True), list[int]()
    first, second = case(vertical_arm, 3, lack=0.3).readings, case(vertical_arm, 4, lack=0.3).readings
    before = smoother.smooth(first, progress=told.append)
    after = smoother.smooth(second, known=before)
    lasting = slice(6, None)
    np.testing.assert_array_equal(after.before[lasting, lasting], before.covariance[lasting, lasting])
    assert after.states.shape == (len(second.values), smoother.size)
    assert told == sorted(told) and told[-1] == before.passes > after.passes


def test_a_gap_is_bridged(vertical_arm: Arm) -> None:
    one = case(vertical_arm, 5, lack=0.3)
    one.readings.values[400:430] = np.nan
    found = DiscrepancySmoother(vertical_arm, np.zeros(2), True).smooth(one.readings)
    assert np.isfinite(found.states).all() and np.isfinite(found.variance).all()
    assert within_3_std(found, one.q) > 0.97


@pytest.mark.parametrize(
    ("n", "rows"), [(12, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]), (5, [0] * 4 + [1]), (14, None)]
)
def test_a_coarse_rest_is_held_at_each_of_its_frames(n: int, rows: list[int] | None) -> None:
    """Each says as little more as there are of them; beyond the last one that holds."""
    rest = np.array([[1.0, 2.0], [0.0, 0.0], [5.0, 7.0]])
    exact = SimpleNamespace(course=SimpleNamespace(dt=0.04, rest=rest))
    found = _rest_at_every_frame(exact, SimpleNamespace(dt=0.01, readings=np.zeros((n, 12))))  # type: ignore[arg-type]
    every = rows or [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2]
    np.testing.assert_array_equal(found, 4.0 * rest[every])
