"""What an arm file says of how well its sensors are known widens what trackers claim."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import SensorCovariance
from tracking.model.observation import MOUNTING_NAMES
from tracking.smoother.smoother import Smoother
from tracking.tracker import tracker_of

RATE_HZ = 250.0


def known_to(arm, share):
    """Return the arm with sensors known to a share of 1 % of scale, 1 degree of turn and 2 mm of place."""
    names = tuple(f"{sensor.name} {name}" for sensor in arm.sensors for name in MOUNTING_NAMES)
    std = share * np.tile(np.repeat([0.01, 0.0175, 0.002], 3), len(arm.sensors))
    rows = np.diag(std**2)
    return replace(
        arm, sensor_covariance=SensorCovariance(names, tuple(tuple(row[: k + 1]) for k, row in enumerate(rows)))
    )


@pytest.mark.parametrize("method", ["filter", "smooth"])
def test_less_known_sensors_give_less_known_angles(upright_bench, decimated, method):
    readings, claimed = decimated(upright_bench, RATE_HZ), []
    for arm in (upright_bench.arm, known_to(upright_bench.arm, 1e-3), known_to(upright_bench.arm, 1.0)):
        if method == "smooth":
            found = Smoother(arm, upright_bench.q[0], True).smooth(readings, fine=False)
            claimed.append(np.sqrt(found.variance[:, ::3]).mean())
        else:
            tracker = tracker_of(arm, "filter", RATE_HZ, upright_bench.q[0], RATE_HZ)
            frames, _ = tracker.push(0, readings.values)
            claimed.append(frames[-1].q_std[len(frames[-1].q_std) // 2 :].mean())
    exact, nearly, vaguely = claimed
    assert nearly == pytest.approx(exact, rel=0.2)
    assert vaguely > 1.5 * exact
