"""An accelerometer's zero that wanders as the run goes on."""

import numpy as np

from arm.counts import COUNT_M_S2

RATES = {"x_m_s3": 0.5, "y_m_s3": -0.2, "z_m_s3": 0.1}


def test_only_its_own_sensor_and_on_the_runs_clock(arm, swung, read, on_sensor):
    motion = swung(arm)
    plain = read(arm, [motion, motion])
    drifting = read(on_sensor(arm, "sensor_drift", **RATES), [motion, motion])
    t = np.arange(1600) * 1e-3
    wandered = np.outer(t, [0.5, -0.2, 0.1])
    np.testing.assert_allclose((drifting - plain)[:, 2], wandered, rtol=0, atol=COUNT_M_S2)
    np.testing.assert_array_equal(np.delete(drifting, 2, axis=1), np.delete(plain, 2, axis=1))


def test_what_it_may_be(ranges):
    for axis in RATES:
        ranges("sensor_drift", axis, -1.0, 1.0, **{name: 0.0 for name in RATES if name != axis})
