"""How large offsets may be by the length of what is read at rest."""

from dataclasses import replace

import numpy as np
import pytest

from arm.accelerometer import specific_force
from arm.model import Arm, Gyroscope
from tracking.model.gravity_length import bound_offsets, calmest_mean
from tracking.model.observation import Observation, observation_of
from tracking.model.readings import Readings, ReadingsBuilder

RATE_HZ, BEFORE_STD = 100.0, 0.3


def read(values: np.ndarray, n_gyro: int = 0) -> Readings:
    builder = ReadingsBuilder(RATE_HZ, values.shape[1], RATE_HZ, n_gyro)
    builder.push(values + 1e-3 * np.random.default_rng(0).standard_normal(values.shape))
    return builder.done()


def resting(arm: Arm, longer: float) -> np.ndarray:
    """Return readings at rest of sensors that each read gravity longer by so much [m/s^2]."""
    still = np.zeros((1, 2))
    felt = specific_force(arm, np.array([[0.4, -0.3]]), still, still)[0]
    felt *= (1.0 + longer / np.linalg.norm(felt, axis=1))[:, None]
    return np.tile(felt.ravel(), (200, 1))


def offset_stds(arm: Arm, readings: Readings) -> tuple[Observation, np.ndarray, np.ndarray]:
    of, size = observation_of(arm)
    P = BEFORE_STD**2 * (0.5 * np.eye(size) + 0.5)
    bound_offsets(of, readings, P)
    return of, np.sqrt(np.diag(P)), P


@pytest.mark.parametrize(("longer", "std"), [(0.05, 0.1), (0.0, 0.02), (1.0, BEFORE_STD)])
def test_offsets_are_no_larger_than_twice_what_the_length_is_off(
    vertical_arm: Arm, longer: float, std: float
) -> None:
    _, stds, P = offset_stds(vertical_arm, read(resting(vertical_arm, longer)))
    np.testing.assert_allclose(stds[6:18], std, rtol=0.02)
    np.testing.assert_allclose(np.delete(stds, np.arange(6, 18)), BEFORE_STD)
    np.testing.assert_allclose(P[6, 0] / stds[6] / stds[0], 0.5)  # correlations stay


def test_only_accelerometers_that_keep_gravity_are_bounded(vertical_arm: Arm) -> None:
    first = replace(vertical_arm.sensors[0], highpass_hz=0.5)
    second = replace(vertical_arm.sensors[1], gyroscope=Gyroscope())
    arm = replace(vertical_arm, sensors=(first, second, *vertical_arm.sensors[2:]))
    values = np.hstack([resting(vertical_arm, 0.05), np.zeros((200, 3))])
    values[:, :3] = 0.0
    _, stds, _ = offset_stds(arm, read(values, 3))
    np.testing.assert_allclose(stds[6:9], BEFORE_STD)
    np.testing.assert_allclose(stds[9:18], 0.1, rtol=0.02)
    np.testing.assert_allclose(stds[18:21], BEFORE_STD)
    coupled = replace(vertical_arm, sensors=tuple(replace(s, highpass_hz=0.5) for s in vertical_arm.sensors))
    np.testing.assert_allclose(offset_stds(coupled, read(values[:, :12]))[1], BEFORE_STD)


def test_the_calmest_quarter_of_a_second_counts(vertical_arm: Arm) -> None:
    values = resting(vertical_arm, 0.05)
    values[:75] += 3.0 * np.sin(np.arange(75.0))[:, None]
    values[150:] += 1.0
    values[160::3] += 0.1
    np.testing.assert_allclose(calmest_mean(read(values)), values[100], atol=2e-3)
    lost = read(values)
    lost.values[:] = np.nan
    lost.values[:10] = values[75]
    np.testing.assert_allclose(calmest_mean(lost), values[75])
