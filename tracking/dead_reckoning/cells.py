"""Several cells of dead reckoning in one go, for as long as no motion begins or ends: compiled.

Handing a kernel all that it carries on takes longer than a cell of 10 ms does.
"""

import numpy as np

from arm.model import Floats
from limbcal.compiled import compiled
from tracking.dead_reckoning.integration import reckon
from tracking.dead_reckoning.integration_state import Reckoning
from tracking.dead_reckoning.rest_cell import RestWindow, judge_cell, learn_offset


@compiled
def reckon_cells(
    state: Reckoning,
    window: RestWindow,
    readings: Floats,
    size: int,
    dt: float,
    hold: bool,
    learns: bool,
    first: int,
    decimation: int,
    phase: int,
    q: Floats,
    moved: Floats,
) -> tuple[int, RestWindow]:
    """Judge cells of ``size`` readings and carry the state through them, until in one a motion begins or ends.

    That one is not taken in. The steps are those of `tracking.dead_reckoning.integrator.Integrator`.

    Parameters
    ----------
    state, dt, first, decimation, phase, q, moved
        See `tracking.dead_reckoning.integration.reckon`; a cell has as many frames as any other.
    window : RestWindow
    readings : (n * size, 3 * n_sensor)
    hold : bool
        Velocities stay zero, as in the cell before.
    learns : bool
        Offsets are learnt while the arm rests.

    Returns
    -------
    done : int
        How many cells were taken in.
    window : RestWindow
        After them.
    """
    excess, before, frames, done = np.empty(window.offset.size), np.empty_like(window.cells), 0, 0
    for k in range(readings.shape[0] // size):
        cell = readings[k * size : (k + 1) * size]
        before[:] = window.cells
        resting, creeping, jolted, least, n_cells = judge_cell(window, cell, state.gravity, excess)
        if resting != window.resting or jolted:
            window.cells[:] = before
            break
        weight = window.weight
        if resting and learns:
            weight = learn_offset(window.offset, weight, excess)
        window = RestWindow(
            resting,
            creeping,
            least,
            window.sigma,
            weight,
            n_cells,
            window.cells,
            window.offset,
            window.slack,
            window.contrast,
            window.rounded,
        )
        frames += reckon(state, cell, dt, hold, first + k * size, decimation, phase, q[frames:], moved[frames:])
        done += 1
    return done, window
