"""Files that are wrong about their sensors, and how what was learnt from them is judged."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import rotation_from_rpy
from arm.model import Arm
from benchmarks.mountings import WRONG, garbled, judged, page


@pytest.fixture(scope="module")
def vertical_arm() -> Arm:
    return load_arm("dd-arm-vertical")


FOUND = {
    "converged": True,
    "passes": 4,
    "not_revealed": [],
    "lengths": {"a1": {"value": 0.31, "std": 0.004}},
}
TRACKED = {"angle_error_deg": {"mean": [0.2, 0.1]}, "within_3_std": [1.0, 1.0]}


@pytest.mark.parametrize("seed", range(5))
def test_axes_are_exchanged_and_lengths_wrong_within_bounds(vertical_arm: Arm, seed: int) -> None:
    file = garbled(vertical_arm, np.random.default_rng(seed))
    for true, sensor in zip(vertical_arm.sensors, file.sensors, strict=True):
        between = rotation_from_rpy(*true.rotation_rad).T @ rotation_from_rpy(*sensor.rotation_rad)
        np.testing.assert_allclose(np.abs(between).max(axis=0), 1.0, atol=1e-9)  # an axis is an axis again
        np.testing.assert_array_less(
            np.abs(np.subtract(sensor.position_m, true.position_m)), WRONG * np.abs(true.position_m) + 1e-12
        )
    lengths = np.array([[joint.a_m for joint in arm.joints] for arm in (vertical_arm, file)])
    assert np.all(np.abs(lengths[1] - lengths[0]) <= WRONG * lengths[0]) and np.any(lengths[1] != lengths[0])


def test_the_true_arm_is_right_and_its_length_counted_in_standard_errors(vertical_arm: Arm) -> None:
    line = judged(vertical_arm, vertical_arm, FOUND, TRACKED)
    assert line["axes"] and max(line["turns_deg"]) < 1e-4
    assert line["lengths"]["a1"] == pytest.approx((0.31 - vertical_arm.joints[0].a_m) / 0.004)


def test_one_sensor_with_a_reversed_axis_is_wrong(vertical_arm: Arm) -> None:
    first, *others = vertical_arm.sensors
    a, b, c = first.rotation_rad
    wrong = replace(vertical_arm, sensors=(replace(first, rotation_rad=(a + np.pi, b, c)), *others))
    line = judged(vertical_arm, wrong, FOUND, TRACKED)
    assert not line["axes"] and line["turns_deg"][0] == pytest.approx(180.0)


def test_the_page_counts_what_was_right_and_lists_what_was_not(vertical_arm: Arm) -> None:
    right = judged(vertical_arm, vertical_arm, FOUND, TRACKED) | {"seconds": 3.0}
    lines = [
        {"key": "dd-arm-vertical/0", "arm": "dd-arm-vertical", **right},
        {"key": "dd-arm-vertical/2", "arm": "dd-arm-vertical", **right, "converged": False},
        {"key": "dd-arm-vertical/4", "arm": "dd-arm-vertical", "error": "ValueError: no motion"},
    ]
    text = page(lines)
    assert "| dd-arm-vertical | 3 | 1 | 2 |" in text
    assert "dd-arm-vertical/4 | ValueError: no motion" in text and "dd-arm-vertical/0 |" not in text
