"""Cells in one go: what comes of them is what comes of each by itself, and the one that changes is left."""

import numpy as np
import pytest

from tracking.dead_reckoning.cells import reckon_cells
from tracking.dead_reckoning.integration_state import reckoning_of
from tracking.dead_reckoning.integrator import Integrator
from tracking.dead_reckoning.rest import RestDetector
from tracking.dead_reckoning.rest_cell import WINDOW

CELL, STEP = 64, 1e-3


def rested(dd_arm):
    """Return a resting arm's state and its detector after a rest at the start."""
    state = reckoning_of(dd_arm, np.zeros(2))
    rest = RestDetector(np.zeros((0, 12)), np.zeros(12))
    for cell in noise(WINDOW + 1).reshape(WINDOW + 1, CELL, 12):
        assert rest.judge(cell, state.gravity, pinned=False)
    return state._replace(offset=rest.offset), rest


def noise(n_cell, seed=0):
    return STEP * np.rint(20.0 * np.random.default_rng(seed).standard_normal((n_cell * CELL, 12)))


def taken(state, rest, readings):
    q, moved = np.full((len(readings) // 32, 2), np.nan), np.full((len(readings) // 32, 4, 3), np.nan)
    done, window = reckon_cells(state, rest.window, readings, CELL, 1e-4, True, True, 0, 32, 16, q, moved)
    return done, window, q


def test_rest_goes_on_to_the_cell_in_which_it_ends(dd_arm):
    state, rest = rested(dd_arm)
    readings = noise(6, seed=1)
    readings[4 * CELL :] += 1.0
    done, window, q = taken(state, rest, readings)
    assert done == 4
    assert window.resting and window.weight == WINDOW + 5
    np.testing.assert_array_equal(q[:8], 0.0)
    assert np.isnan(q[8:]).all()


def test_what_the_last_cell_would_have_changed_is_as_it_was(dd_arm):
    state, rest = rested(dd_arm)
    cells, offset = rest.window.cells.copy(), rest.offset.copy()
    done, window, _ = taken(state, rest, noise(1) + 1.0)
    assert done == 0
    np.testing.assert_array_equal(window.cells, cells)
    np.testing.assert_array_equal(rest.offset, offset)


def test_the_detector_goes_on_where_the_kernel_left_it(dd_arm):
    """By cell after cell of another one."""
    state, rest = rested(dd_arm)
    other = rested(dd_arm)[1]
    readings = noise(5, seed=2)
    done, window, _ = taken(state, rest, readings)
    rest.go_on(window)
    assert done == 5
    for cell in readings.reshape(5, CELL, 12):
        other.judge(cell, state.gravity, pinned=False)
    for one, two in zip(rest.window, other.window, strict=True):
        np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize("zero", ["each-rest", "first-rest"])
def test_a_motion_is_that_of_cells_one_by_one(dd_arm, recorded, tracked, monkeypatch, zero):
    from tests.tracking.dead_reckoning.test_integrator import SHORT  # noqa: PLC0415

    recording = recorded(dd_arm, SHORT, 2, noise=1.0)
    together = tracked(recording, zero=zero)
    assert together.phases
    monkeypatch.setattr(Integrator, "_stride", lambda *_: 0)
    assert tracked(recording, zero=zero).bytes() == together.bytes()
