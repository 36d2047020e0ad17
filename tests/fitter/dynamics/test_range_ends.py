"""Columns of tissue at the ends of a range, and the rates between those that are tried."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.effects.joint_torque import N_STATE, Q, torque_along
from fitter.dynamics.range_ends import RATES, RangeEnd, end_columns


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_column_is_the_catalogues_tissue(side):
    q = np.linspace(-1.0, 1.0, 21)[:, None]
    states = np.zeros((len(q), N_STATE))
    states[:, Q] = q[:, 0]
    wanted = torque_along(catalogue()["passive_tissue"], np.array([side * 0.9, 1.0, 8.0, 0.0, side]), states)
    columns = end_columns([RangeEnd(0, side, side * 0.9, 8.0)], q, order=0)
    np.testing.assert_allclose(columns[:, 0, 0], wanted, rtol=1e-13)


def test_each_end_acts_at_its_own_joint():
    ends = [RangeEnd(0, 1.0, 0.5, 4.0), RangeEnd(2, -1.0, -0.5, 4.0)]
    columns = end_columns(ends, np.zeros((1, 3)), order=1)
    assert [np.flatnonzero(columns[0, :, k]).tolist() for k in range(4)] == [[0], [2], [0], [2]]


def test_the_first_order_covers_the_rates_between_those_tried():
    """The two columns of a rate span the tissue of the next one, a quarter of an octave away, to 2 %."""
    q = np.linspace(-1.5, 0.0, 400)[:, None]
    for rate in RATES:
        columns = end_columns([RangeEnd(0, 1.0, 0.0, float(rate))], q, order=1)[:, 0]
        between = np.exp(rate * 2.0**0.25 * q[:, 0])
        left = between - columns @ np.linalg.lstsq(columns, between, rcond=None)[0]
        assert np.abs(left).max() < 2e-2
        assert np.sqrt(np.mean(left**2) / np.mean(between**2)) < 2e-2
