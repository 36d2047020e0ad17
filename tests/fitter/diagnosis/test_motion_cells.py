"""Cells hold equal shares of the time, are alike in all trials, and no two joints share one."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.motion_cells import N_PART, cells_of
from tests.fitter.diagnosis.two_joints import regression_of_two


@pytest.fixture(scope="module")
def motions():
    return regression_of_two(trials=3).motions


def test_parts_of_angle_and_of_velocity_are_equally_long(motions):
    cells = np.concatenate(cells_of(motions))
    n = len(cells)
    for joint, column in enumerate(cells.T):
        own = column - joint * N_PART**2
        assert np.all((own >= 0) & (own < N_PART**2))
        for part in (own // N_PART, own % N_PART):
            np.testing.assert_allclose(np.bincount(part, minlength=N_PART), n / N_PART, atol=1)


def test_a_joint_that_moves_alike_is_in_the_same_cell_in_any_trial(motions):
    one, two, _ = motions
    both = cells_of([one, replace(one, q=one.q.copy()), two])
    np.testing.assert_array_equal(both[0], both[1])
    assert not set(both[0][:, 0]) & set(both[0][:, 1])
