"""What all plates of a trial do to the person: one wrench at the world's origin, on the motion's times.

A point of application is meaningless while a plate is empty and must not be interpolated: moments about the
world's origin can be. Samples in which a plate's file has no number are of no use; that is said.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from arm.model import Floats
from fitter.data.derivatives import lowpass
from limbcal.errors import DataError
from limbcal.note import Note
from protocol.markers.wrench_files import EMPTY_N, PlateWrench

#: Corner before a force is sampled at a lower rate, as a share of that rate: below its Nyquist frequency.
_ANTI_ALIAS = 0.4
#: A plate is empty while its force keeps below this, for at least this fraction of the trial: it reads its zero.
_EMPTY_SHARE = 0.1
#: A zero smaller than this is of no matter [N].
_ZERO_N = 1.0


def wrench_at_origin(plate: PlateWrench) -> Floats:
    """Return a plate's force and moment about the world's origin on its own times, (n, 6), NaN for none."""
    moment = np.cross(np.nan_to_num(plate.point_m), plate.force) + np.nan_to_num(plate.moment)
    return np.hstack([plate.force, moment])


def ground_wrench(
    plates: Sequence[PlateWrench], t: Floats, where: str
) -> tuple[Floats, NDArray[np.bool_], list[Note]]:
    """Return the sum of all plates.

    Parameters
    ----------
    plates : sequence of PlateWrench
    t : (n_sample,) [s]
        On the plates' clock, evenly spaced.
    where : str
        The force file, for errors.

    Returns
    -------
    wrench : (n_sample, 6)
        Force, and moment about the world's origin [N], [N m].
    known : (n_sample,) bool
        Where every plate has numbers.
    notes : list of Note

    Raises
    ------
    DataError
        If the plates and the motion have no time in common.
    """
    total, known, notes = np.zeros((len(t), 6)), np.ones(len(t), dtype=np.bool_), []
    step = float(np.median(np.diff(t)))
    for plate in plates:
        if plate.t[-1] < t[0] or plate.t[0] > t[-1]:
            raise DataError(
                f"{where}: {plate.name} has forces from {plate.t[0]:.2f} to {plate.t[-1]:.2f} s and the motion "
                f"is from {t[0]:.2f} to {t[-1]:.2f} s, expected one clock"
            )
        wrench = wrench_at_origin(plate)
        bad: NDArray[np.bool_] = np.any(~np.isfinite(wrench), axis=1)
        if bad.any():
            text = f"{plate.name}: {int(bad.sum())} of {len(bad)} samples have no number and are left out"
            notes.append(Note("nan_forces", text))
        wrench, note = _zeroed(_bridged(wrench, bad), bad, plate)
        notes += note
        own = float(np.median(np.diff(plate.t)))
        if own < 0.5 * step:
            wrench = lowpass(wrench, own, _ANTI_ALIAS / step, ends="even")
        total += np.column_stack([np.interp(t, plate.t, column) for column in wrench.T])
        known &= np.interp(t, plate.t, bad.astype(np.float64)) == 0.0
        known &= (t >= plate.t[0] - 1e-9) & (t <= plate.t[-1] + 1e-9)
    return total, known, notes


def _bridged(wrench: Floats, bad: NDArray[np.bool_]) -> Floats:
    """Return a wrench with straight lines over samples without a number, which a filter spreads to others."""
    if not bad.any() or bad.all():
        return np.where(bad[:, None], 0.0, wrench)
    at = np.arange(len(bad))
    return np.column_stack([np.interp(at, at[~bad], column[~bad]) for column in wrench.T])


def _zeroed(wrench: Floats, bad: NDArray[np.bool_], plate: PlateWrench) -> tuple[Floats, list[Note]]:
    """Take off what a plate reads while nothing is on it."""
    size = np.linalg.norm(wrench[:, :3], axis=1)
    empty = (size < 2.0 * EMPTY_N) & ~bad
    if not plate.is_loaded or empty.sum() < _EMPTY_SHARE * len(empty):
        return wrench, []
    zero = np.median(wrench[empty], axis=0)
    if np.linalg.norm(zero[:3]) < _ZERO_N:
        return wrench, []
    text = f"{plate.name} reads {np.linalg.norm(zero[:3]):.1f} N while nothing is on it: taken off"
    return wrench - zero, [Note("plate_zero", text)]
