"""The covariance of sensors in an arm file, and what trackers make of it."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import format_arm, load_arm, parse_arm
from arm.model import SensorCovariance
from limbcal.errors import ConfigError

ARM = load_arm("dd-arm")
KNOWN = SensorCovariance(("s1 scale_x", "s1 turn_z"), ((1e-4,), (-2e-5, 4e-5)))


def test_a_file_gives_it_back():
    arm = replace(ARM, sensor_covariance=KNOWN)
    assert parse_arm(format_arm(arm), "arm.toml") == arm
    np.testing.assert_array_equal(KNOWN.matrix(), [[1e-4, -2e-5], [-2e-5, 4e-5]])


@pytest.mark.parametrize(
    ("known", "said"),
    [
        (SensorCovariance(("s9 scale_x",), ((1.0,),)), "'s9 scale_x', expected a sensor (s1, s2, s3, s4)"),
        (SensorCovariance(("s1 colour",), ((1.0,),)), "'s1 colour'"),
        (SensorCovariance(("s1 scale_x", "s1 scale_y"), ((1.0,),)), "1 rows, expected a lower triangle of 2 rows"),
        (SensorCovariance(("s1 scale_x", "s1 scale_y"), ((1.0,), (2.0, 1.0))), "negative in some direction"),
    ],
)
def test_what_is_wrong_with_it_is_said(known, said):
    with pytest.raises(ConfigError) as caught:
        parse_arm(format_arm(replace(ARM, sensor_covariance=known)), "arm.toml")
    assert said in str(caught.value)
