"""A sample of 16 bits spans five times standard gravity to either side."""

import pytest

from arm.counts import COUNT_M_S2, FULL_SCALE_M_S2


def test_full_scale_is_five_times_gravity_in_as_many_counts_as_16_bits_have():
    assert pytest.approx(5.0 * 9.80665) == FULL_SCALE_M_S2
    assert pytest.approx(FULL_SCALE_M_S2) == COUNT_M_S2 * 2**15
