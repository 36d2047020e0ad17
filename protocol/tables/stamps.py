"""What time stamps must be like, and where they leap: memory follows samples, never time."""

import numpy as np
from numpy.typing import NDArray

from limbcal.errors import DataError
from protocol.tables.clock import likely_units
from protocol.tables.table import Floats, Labels

#: More steps than this without a sample may be a leap.
HOLE_STEPS = 10
#: Rows of a motion come at least this often [s]: the quickest joint motions have 10 Hz, the slowest arms are
#: recorded at 1 Hz. Stamps further apart are not in seconds.
SLOWEST_STEP_S = 1.0


def require_rising(t: Floats, where: str, first_row: int = 0) -> None:
    """Raise a DataError where time stands still or runs backwards, naming the row (from 1)."""
    steps = np.diff(t)
    if not (steps > 0.0).all():
        k = int(np.argmin(steps > 0.0))
        said = "stands still at" if steps[k] == 0.0 else f"runs backwards from {t[k]:.9g} s to"
        raise DataError(
            f"{where}: in row {first_row + k + 2} time {said} {t[k + 1]:.9g} s, "
            "expected it to rise until a column 'trial' says that another trial begins"
        )


def require_seconds(t: Floats, where: str, option: str = "--columns t=t") -> None:
    """Raise a DataError where rows lie so far apart that their stamps can't be seconds, with the likely unit."""
    if len(t) < 2:
        return
    step = float(np.median(np.diff(t)))
    if not step > SLOWEST_STEP_S:
        return
    fitting = likely_units(step)
    asked = f"are they in {' or '.join(fitting)}? then {option}:{fitting[0]}" if fitting else "in which unit?"
    raise DataError(
        f"{where}: stamps lie {step:.6g} apart, expected seconds, and a row every {SLOWEST_STEP_S:g} s at least; "
        f"{asked}"
    )


def holes(t: Floats) -> NDArray[np.intp]:
    """Return the rows before which more than `HOLE_STEPS` of the usual steps are missing.

    Parameters
    ----------
    t : ndarray of shape (n,)
        Rising time stamps [s].

    Returns
    -------
    rows : ndarray of int
        The first rows after holes, rising; 0 is never one of them.
    """
    steps = np.diff(t)
    if not steps.size:
        return np.empty(0, dtype=np.intp)
    return np.flatnonzero(steps > HOLE_STEPS * np.median(steps)) + 1


def leaps(t: Floats) -> NDArray[np.intp]:
    """Return the rows before which time leaps: by more than all that was measured takes.

    The holes that are none of these take no longer in sum than what was measured, so that a grid over each piece
    is bounded by the number of samples.

    Parameters
    ----------
    t : ndarray of shape (n,)
        Rising time stamps [s].

    Returns
    -------
    rows : ndarray of int
        The first rows after leaps, rising; 0 is never one of them.
    """
    rows = holes(t)
    if not rows.size:
        return rows
    steps = np.diff(t)
    lasting = steps[rows - 1]
    order = np.argsort(lasting, kind="stable")
    measured_s = float(np.delete(steps, rows - 1).sum())
    return np.sort(rows[order[np.cumsum(lasting[order]) > measured_s]])


def trial_rows(labels: Labels | None, n: int, where: str, first_row: int = 0) -> list[tuple[str, int, int]]:
    """Return the label of each trial and where its rows begin and end; one trial where there are no labels.

    Raises
    ------
    DataError
        If a trial goes on after another one, or a row is of none.
    """
    if labels is None:
        return [("", 0, n)]
    bounds = [0, *(np.flatnonzero(labels[1:] != labels[:-1]) + 1).tolist(), n]
    found: dict[str, tuple[str, int, int]] = {}
    for begin, end in zip(bounds[:-1], bounds[1:], strict=True):
        label = str(labels[begin])
        if not label:
            row = first_row + begin + 1
            raise DataError(f"{where}: there is no trial in row {row}, expected a name or a number")
        if label in found:
            raise DataError(
                f"{where}: trial {label!r} goes on in row {first_row + begin + 1} after another one, "
                "expected each trial in one piece"
            )
        found[label] = (label, begin, end)
    return list(found.values())
