"""Motions parted where their time leaps: a gap is a gap, and memory follows samples."""

from dataclasses import replace

from fitter.data.motions import Measured, require_rising
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.tables.stamps import leaps

#: Fewer samples than this say nothing about a motion.
MINIMUM_SAMPLES = 16


def split_at_leaps(motion: Measured) -> list[Measured]:
    """Part a motion where time leaps by more than all that was measured takes.

    Parameters
    ----------
    motion : Measured

    Returns
    -------
    list of Measured
        Pieces of at least `MINIMUM_SAMPLES`; the first one's notes say where it was parted. The motion itself
        where nothing leaps.

    Raises
    ------
    DataError
        If time does not rise, or no piece is long enough.
    """
    require_rising(motion)
    rows = leaps(motion.t).tolist()
    if not rows:
        return [motion]
    bounds = [0, *rows, len(motion.t)]
    spans = [span for span in zip(bounds[:-1], bounds[1:], strict=True) if span[1] - span[0] >= MINIMUM_SAMPLES]
    notes = tuple(leap_note(motion, row, len(spans)) for row in rows)
    if not spans:
        raise DataError(
            f"{motion.where}: {notes[0].text.partition(':')[0]}, and no piece has {MINIMUM_SAMPLES} samples; "
            "expected rows that follow one another"
        )
    pieces = [motion.piece(begin, end, k + 1) for k, (begin, end) in enumerate(spans)]
    first = replace(pieces[0], notes=(*pieces[0].notes, *notes))
    return [first, *(replace(piece, notes=()) for piece in pieces[1:])]


def leap_note(motion: Measured, row: int, pieces: int) -> Note:
    """Return what there is to say of a leap before a row (from 0)."""
    before, after = float(motion.t[row - 1]), float(motion.t[row])
    place = motion.first_row + row + 1
    text = (
        f"in row {place} t leaps from {before:.9g} to {after:.9g} s: a clock that was set, or rows are missing; "
        f"parted there into {pieces} run{'' if pieces == 1 else 's'}"
    )
    return Note("gap", text, source=motion.where, columns=("t",), row=place, from_s=before, to_s=after)
