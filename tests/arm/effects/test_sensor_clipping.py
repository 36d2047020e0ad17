"""A sensor whose range is too small for what it feels."""

import numpy as np

from arm.counts import COUNT_M_S2
from arm.effects.sensor_clipping import EFFECT


def test_a_sensor_clips_what_it_would_have_read(arm, swung, read, on_sensor):
    motion = swung(arm)
    plain, clipped = read(arm, [motion]), read(on_sensor(arm, "sensor_clipping", level_m_s2=6.0), [motion])
    assert np.abs(plain[:, 2]).max() > 7.0
    np.testing.assert_allclose(clipped[:, 2], np.clip(plain[:, 2], -6.0, 6.0), rtol=0, atol=COUNT_M_S2)
    np.testing.assert_array_equal(np.delete(clipped, 2, axis=1), np.delete(plain, 2, axis=1))


def test_within_its_range_it_reads_what_it_feels():
    a = np.array([[-7.0, -6.0, -1.5], [6.5, 5.9, 0.0]])
    found = EFFECT.converted(a, np.zeros(2), np.empty((0, 3, 3)), {"level_m_s2": 6.0})
    assert found.tolist() == [[-6.0, -6.0, -1.5], [6.0, 5.9, 0.0]]


def test_a_range_is_more_than_nothing(ranges, accepts):
    ranges("sensor_clipping", "level_m_s2", 1e-3, 1e6)
    assert accepts("sensor_clipping", level_m_s2=np.inf)
