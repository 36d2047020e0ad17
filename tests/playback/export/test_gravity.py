"""Up is against gravity."""

from dataclasses import replace

import pytest

from arm.model import Arm
from playback.export.gravity import upward
from tests.playback.export.conftest import SLIDING


@pytest.mark.parametrize(
    ("gravity", "up"),
    [
        ((0.0, 0.0, -9.81), (0.0, 0.0, 1.0)),
        ((0.0, 3.0, 4.0), (0.0, -0.6, -0.8)),
        ((1e-8, 0.0, 0.0), (-1.0, 0.0, 0.0)),
        ((1e-10, 0.0, 0.0), (0.0, 0.0, 1.0)),  # nothing pulls
        ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ],
)
def test_up_is_a_unit_vector_against_what_pulls(gravity: tuple[float, ...], up: tuple[float, ...]) -> None:
    arm: Arm = replace(SLIDING, gravity_m_s2=gravity)
    assert upward(arm) == pytest.approx(up)
