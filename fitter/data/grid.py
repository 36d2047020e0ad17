"""The uniform grid of a long motion, laid stretch by stretch."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fitter.data.derivatives import lowpass
from fitter.data.motions import Measured
from fitter.data.resample import ANTI_ALIAS, CROWDED, curve_through, time_step
from fitter.data.windows import forgetting_samples
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES

Floats = NDArray[np.float64]

#: A curve through samples forgets an edge by a factor of two and more a sample.
CURVE_SAMPLES = 64
#: Irregular stamps may crowd: then as much time has more rows.
_CROWDING = 1.5
#: The step of a stretch may be off that of the beginning by this share: clocks drift.
_DRIFT = 1e-3


@dataclass(frozen=True)
class Grid:
    """A uniform grid in time.

    Attributes
    ----------
    t0 : float
        Its first instant [s].
    step_s, own_step_s : float
        Its step, and that of the stamps.
    as_measured : bool
        The samples are on it already.
    """

    t0: float
    step_s: float
    own_step_s: float
    as_measured: bool

    def rows(self, samples: int) -> int:
        """Return how many rows of the file span a number of the grid's samples, with what it takes to lay it."""
        if self.as_measured:
            return samples + CURVE_SAMPLES
        span = samples * self.step_s / self.own_step_s + CURVE_SAMPLES
        if self._thins:
            span += forgetting_samples(self.own_step_s, ANTI_ALIAS / self.step_s)
        return math.ceil(_CROWDING * span)

    def lay(self, rows: Measured, counted: slice) -> tuple[Measured, slice]:
        """Put rows on the grid.

        Parameters
        ----------
        rows : Measured
            Consecutive rows, margins included.
        counted : slice
            Which of them count.

        Returns
        -------
        rows : Measured
            Samples of the grid, in a time that begins at 0.
        counted : slice
            Which of these count: side by side, stretches count every instant of the grid once.

        Raises
        ------
        DataError
            If the rows were on the grid so far and no longer are.
        """
        if self.as_measured:
            step_s, uniform = time_step(rows.t)
            if not uniform or abs(step_s - self.step_s) > _DRIFT * self.step_s:
                raise DataError(
                    f"{rows.where}: trial {rows.name!r} had a sample every {self.step_s:.9g} s, but in rows "
                    f"{rows.first_row + 1} to {rows.first_row + len(rows.t)} stamps are off that by more than a "
                    "trifle; expected an even rate throughout so long a trial, or a rate to resample it to"
                )
            stamps: Floats = self.step_s * np.arange(len(rows.t), dtype=np.float64)
            return replace(rows, t=stamps), counted
        t = rows.t - self.t0
        first, last = self._instants(t[0], t[-1])
        # an instant belongs to the stretch in which the row before it, or it itself, counts
        begin = self._instants(t[counted.start], t[-1])[0]
        end = self._instants(t[counted.stop], t[-1])[0] if counted.stop < len(t) else last
        grid = self.step_s * np.arange(first, last, dtype=np.float64)
        columns = self._laid(rows, t, grid)
        note = Note("resampled", f"resampled to {1e3 * self.step_s:.6g} ms", columns=("t",))
        stamps = self.step_s * np.arange(len(grid), dtype=np.float64)
        laid = replace(rows, t=stamps, columns=columns, labels=None, notes=(*rows.notes, note))
        return laid, slice(begin - first, end - first)

    @property
    def _thins(self) -> bool:
        return self.step_s > 1.5 * self.own_step_s

    def _instants(self, begin_s: float, end_s: float) -> tuple[int, int]:
        """Return the instants of the grid from one time to another, as in a slice."""
        return math.ceil(begin_s / self.step_s - 1e-6), math.floor(end_s / self.step_s + 1e-6) + 1

    def _laid(self, rows: Measured, t: Floats, grid: Floats) -> dict[str, Floats]:
        steps = np.diff(t)
        crowded = bool(steps.min() < CROWDED * self.own_step_s)
        columns = dict(rows.columns)
        if self._thins:
            first = math.ceil(t[0] / self.own_step_s - 1e-6)
            fine = self.own_step_s * np.arange(first, math.floor(t[-1] / self.own_step_s + 1e-6) + 1)
            corner_hz = ANTI_ALIAS / self.step_s
            columns = {
                role: curve_through(role, t, values, crowded)(fine)
                if role in DRIVE_ROLES
                else lowpass(curve_through(role, t, values, crowded)(fine), self.own_step_s, corner_hz)
                for role, values in columns.items()
            }
            t = fine
        return {role: curve_through(role, t, values, crowded)(grid) for role, values in columns.items()}


def grid_of(t: Floats, rate_hz: float | None) -> Grid:
    """Return the grid for a motion that begins with these stamps [s]."""
    own_step_s, uniform = time_step(t)
    step_s = own_step_s if rate_hz is None else 1.0 / rate_hz
    as_measured = uniform and abs(step_s - own_step_s) <= 1e-6 * own_step_s
    return Grid(float(t[0]), own_step_s if as_measured else step_s, own_step_s, as_measured)
