"""A live filter of an arm that is not quite the one in its file: angles, claims, and who is believed when."""

import numpy as np
import pytest

from arm.model import Arm
from tests.tracking.smoother.test_discrepancy_smoother import RATE_HZ, case
from tracking.kalman.kalman_filter import KalmanTracker


def followed(arm: Arm, readings: np.ndarray, at_once: int = 50) -> tuple[np.ndarray, np.ndarray, KalmanTracker]:
    tracker, frames = KalmanTracker(arm, RATE_HZ, np.zeros(2), RATE_HZ), []
    for k in range(0, len(readings), at_once):
        frames += tracker.push(round(1e9 * k / RATE_HZ), readings[k : k + at_once])[0]
    frames += tracker.flush()[0]
    return np.vstack([one.q for one in frames]), np.vstack([one.q_std for one in frames]), tracker


@pytest.mark.parametrize(("base", "lack", "error_deg"), [(0.0, 0.3, 2.0), (1.0, 0.05, 3.0)])
def test_what_the_model_lacks_is_claimed(vertical_arm: Arm, base: float, lack: float, error_deg: float) -> None:
    one = case(vertical_arm, 1, base=base, lack=lack, seconds=12.0)
    q, std, tracker = followed(vertical_arm, one.readings.values)
    off = np.abs(q - one.q)
    assert np.mean(off < 3.0 * std) > 0.95
    assert np.degrees(off.mean()) < error_deg
    said = tracker.consistency()
    assert said.wrong and said.discrepancy_m_s2 is not None and said.base_m_s2 is not None
    assert (said.base_m_s2 > 0.3) == (base > 0.0)
    assert max(said.discrepancy_m_s2, said.base_m_s2) == pytest.approx(max(base, lack), rel=0.7)


def test_what_comes_out_does_not_depend_on_how_readings_are_cut(vertical_arm: Arm) -> None:
    readings = case(vertical_arm, 2, base=0.3).readings.values[:300]
    q, std, _ = followed(vertical_arm, readings, 300)
    other_q, other_std, _ = followed(vertical_arm, readings, 7)
    np.testing.assert_array_equal(q, other_q)
    np.testing.assert_array_equal(std, other_std)


def test_an_arm_is_believed_again_some_time_after_it_was_shaken(vertical_arm: Arm) -> None:
    shaken, calm = case(vertical_arm, 3, base=1.0), case(vertical_arm, 3)
    rest = np.tile(calm.readings.values[:90], (16, 1))
    readings = np.vstack([shaken.readings.values[:300], rest])
    _, _, tracker = followed(vertical_arm, readings)
    assert tracker.consistency().wrong
    q, std, _ = followed(vertical_arm, np.vstack([readings, rest[:200]]))
    tracker.push(round(1e9 * len(readings) / RATE_HZ), rest[:200])
    assert not tracker.consistency().wrong
    assert (np.abs(q[-100:]) < 3.0 * std[-100:] + 0.01).all()


def test_a_gap_is_bridged_and_claims_grow(vertical_arm: Arm) -> None:
    one = case(vertical_arm, 4, base=0.3, seconds=8.0)
    tracker = KalmanTracker(vertical_arm, RATE_HZ, np.zeros(2), RATE_HZ)
    readings = one.readings.values
    before, _ = tracker.push(0, readings[:500])
    bridged, _ = tracker.gap(60)
    after, _ = tracker.push(round(1e9 * 560 / RATE_HZ), readings[560:])
    assert bridged[-1].n > 0 and bridged[-1].q_std[-1].max() > 3.0 * before[-1].q_std[-1].max()
    q, std = (np.vstack([getattr(block, name) for block in after]) for name in ("q", "q_std"))
    off = np.abs(q - one.q[-len(q) :])
    assert np.mean(off[100:] < 3.0 * std[100:]) > 0.9
