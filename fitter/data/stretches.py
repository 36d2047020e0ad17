"""Motions out of rows that come block by block: short ones whole, long ones in stretches that overlap.

What a zero-phase filter makes of the inside of a stretch is what it would make of the whole motion, to rounding,
if the stretch has the margin on either side that the filter looks across, see `fitter.data.windows`.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fitter.data.grid import Grid, grid_of
from fitter.data.leaps import MINIMUM_SAMPLES
from fitter.data.motions import Measured, require_rising
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.stamps import HOLE_STEPS


@dataclass(frozen=True)
class Stretch:
    """Some rows of a motion.

    Attributes
    ----------
    motion : Measured
        The rows, margins included.
    counted : slice
        Those that count; every row of a motion counts in one stretch.
    begins, ends : bool
        Whether the motion begins and ends here.
    step_s : float
        A motion of one stretch is as it was measured (0). One of several is on a uniform grid already, of this
        step, and its time begins anew with every stretch.
    """

    motion: Measured
    counted: slice
    begins: bool
    ends: bool
    step_s: float = 0.0

    @property
    def whole(self) -> bool:
        """Say whether it is all of its motion."""
        return self.begins and self.ends


def stretches(
    blocks: Iterable[Measured], longest: int, margin: Callable[[float], int], rate_hz: float | None = None
) -> Iterator[Stretch]:
    """Part blocks of rows by motion, and long motions into stretches.

    Parameters
    ----------
    blocks : iterable of Measured
        Rows in the order of their file. Another name or label is another motion.
    longest : int
        A motion of more samples is parted into stretches of this length, or two margins if that is more.
    margin : callable
        Given the step of the grid [s], how many samples of it are needed on either side.
    rate_hz : float, optional
        Rate of the grid that long motions are put on. Default: their own.

    Yields
    ------
    Stretch
        One motion after the other, each from its beginning to its end.

    Raises
    ------
    DataError
        If a trial is not in one piece, time does not rise, or the stamps of a long motion leave its grid.
    """
    current: _Motion | None = None
    seen: set[tuple[str, str]] = set()
    for rows, label in _runs(blocks):
        if current is not None and current.key != (rows.name, label):
            yield from current.rest()
            current = None
        if current is None:
            if (rows.name, label) in seen:
                raise DataError(
                    f"{rows.where}: trial {label!r} goes on in row {rows.first_row + 1} after another one, "
                    "expected each trial in one piece"
                )
            seen.add((rows.name, label))
            current = _Motion((rows.name, label), longest, margin, rate_hz)
        yield from current.take(rows)
    if current is not None:
        yield from current.rest()


def _runs(blocks: Iterable[Measured]) -> Iterator[tuple[Measured, str]]:
    """Part blocks where the label changes."""
    for block in blocks:
        if block.labels is None:
            yield block, ""
            continue
        bounds = [0, *(np.flatnonzero(block.labels[1:] != block.labels[:-1]) + 1).tolist(), len(block.labels)]
        for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
            yield block.rows(begin, end, block.name), str(block.labels[begin])


class _Motion:
    """One motion while its rows come in."""

    def __init__(
        self, key: tuple[str, str], longest: int, margin: Callable[[float], int], rate_hz: float | None
    ) -> None:
        self.key = key
        self._longest, self._margin_of, self._rate_hz = longest, margin, rate_hz
        self._parts: list[Measured] = []
        self._held = 0
        self._pieces = 0
        self._start_anew()

    def _start_anew(self) -> None:
        """Forget the grid; the rows held begin a piece of their own."""
        self._grid: Grid | None = None  # once the piece is known to be long
        self._margin, self._portion = 0, self._longest
        self._begins, self._first = True, 0  # of the rows held, the first that was not given out yet

    def take(self, rows: Measured) -> Iterator[Stretch]:
        """Take rows in, and give out what is complete."""
        self._parts.append(rows)
        self._held += len(rows.t)
        while self._held > self._first + self._portion + self._margin:
            yield from self._next(over=False)

    def rest(self) -> Iterator[Stretch]:
        """Give out the rest."""
        while self._held:
            yield from self._next(over=True)

    def _next(self, over: bool) -> Iterator[Stretch]:
        """Give out a stretch, or find out first what comes."""
        rows = joined(self._parts)
        self._parts = [rows]
        require_rising(rows)
        if over and self._grid is None and not self._pieces and self._held <= self._longest:
            yield self._whole(rows, self._held)
            return
        steps = np.diff(rows.t)
        usual_s = float(np.median(steps)) if self._grid is None else self._grid.own_step_s
        holes = np.flatnonzero(steps > HOLE_STEPS * usual_s)
        end = int(holes[0]) + 1 if holes.size else self._held
        if self._grid is not None:
            yield from self._parted(rows, end)
        elif end > self._longest:
            self._grid = grid_of(rows.t[:end], self._rate_hz)
            self._margin = self._grid.rows(self._margin_of(self._grid.step_s))
            self._portion = max(self._longest, 2 * self._margin)
        elif end < MINIMUM_SAMPLES:
            self._hold(rows, end)
        else:
            yield self._whole(rows, end)

    def _whole(self, rows: Measured, end: int) -> Stretch:
        """Return rows up to ``end`` as a piece that is not long."""
        piece = self._named(rows.rows(0, end, rows.name, *self._gap(rows, end)), end < self._held)
        self._pieces += 1
        self._hold(rows, end)
        return Stretch(piece, slice(0, end), True, True)

    def _parted(self, rows: Measured, end: int) -> Iterator[Stretch]:
        """Give out the next stretch of a long piece, of which rows up to ``end`` are here."""
        stop = self._first + self._portion
        if stop + self._margin >= end:  # which is the piece's: of one that goes on more than that is held
            stop = end
        begin, until = max(0, self._first - self._margin), min(end, stop + self._margin)
        cut = end < self._held
        assert self._grid is not None
        inside, counted = self._grid.lay(
            self._named(rows.rows(begin, until, rows.name, *(self._gap(rows, end) if stop == end else ())), cut),
            slice(self._first - begin, stop - begin),
        )
        yield Stretch(inside, counted, self._begins, stop == end, self._grid.step_s)
        if stop == end:
            self._pieces += 1
            self._hold(rows, end)
            self._start_anew()
        else:
            self._hold(rows, stop - self._margin)
            self._begins, self._first = False, self._margin

    def _gap(self, rows: Measured, end: int) -> tuple[Note, ...]:
        """Return what there is to say where a piece ends before its motion does."""
        if end >= self._held:
            return ()
        before, after, row = float(rows.t[end - 1]), float(rows.t[end]), rows.first_row + end + 1
        text = f"in row {row} t leaps from {before:.9g} to {after:.9g} s: parted there"
        return (Note("gap", text, source=rows.where, columns=("t",), row=row, from_s=before, to_s=after),)

    def _hold(self, rows: Measured, begin: int) -> None:
        """Go on with the rows from some row on."""
        self._held = len(rows.t) - begin
        self._parts = [rows.rows(begin, len(rows.t), rows.name)] if self._held else []

    def _named(self, rows: Measured, cut: bool) -> Measured:
        """Call rows by their trial, and by their piece if there are several."""
        label = f"/{self.key[1]}" if rows.labels is not None else ""
        piece = f"#{self._pieces + 1}" if cut or self._pieces else ""
        return replace(rows, name=f"{rows.name}{label}{piece}")


def joined(parts: Sequence[Measured]) -> Measured:
    """Return consecutive rows as one."""
    if len(parts) == 1:
        return parts[0]
    first = parts[0]
    columns = {role: np.concatenate([part.columns[role] for part in parts]) for role in first.columns}
    labels = [part.labels for part in parts if part.labels is not None]
    return replace(
        first,
        t=np.concatenate([part.t for part in parts]),
        columns=columns,
        labels=np.concatenate(labels) if labels else None,
    )
