"""Markers are where sensors at the same places are, and those of the base stand."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from arm.kinematics import sensor_positions
from arm.marker_positions import marker_positions
from arm.model import Marker


@pytest.mark.parametrize("name", ["dd-arm", "spatial-arm"])
def test_a_marker_is_where_a_sensor_at_its_place_is(name: str) -> None:
    arm = load_arm(name)
    on_sensors = tuple(Marker(one.name, one.joint, one.position_m) for one in arm.sensors)
    q = np.random.default_rng(2).uniform(-1.5, 1.5, (7, arm.n_joint))
    found = marker_positions(replace(arm, markers=on_sensors), q)
    np.testing.assert_allclose(found, sensor_positions(arm, q), atol=1e-12)


def test_a_marker_of_the_base_stands() -> None:
    arm = replace(load_arm("dd-arm"), markers=(Marker("plate", 0, (0.1, 0.2, 0.3)),))
    found = marker_positions(arm, np.random.default_rng(3).uniform(-1.0, 1.0, (4, 2)))
    assert found[:, 0].tolist() == [[0.1, 0.2, 0.3]] * 4
