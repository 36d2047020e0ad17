"""The trials of a motion file, each on a clock of its own, with the joints' columns side by side."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from limbcal.errors import DataError
from protocol.motion_file import Columns, Floats, joint_columns, read_columns

Signals = dict[str, Floats]


def read_trials(path: Path, needed: Sequence[str], optional: Sequence[str] = ()) -> dict[int, Signals]:
    """Read the signals of every trial in a joint-motion file.

    Parameters
    ----------
    path : Path
        CSV, Parquet or NPZ with the columns ``t`` [s], the numbered columns of every needed signal, such as
        ``q1 … qn``, and where there are several trials a column ``trial`` of whole numbers.
    needed, optional : sequence of str
        Names of signals without the joint's number. Further columns are not looked at.

    Returns
    -------
    dict of int to dict of str to ndarray
        By trial: ``t`` of shape (n,) starting at 0, and the signals found, of shape (n, n_joint).
        A file without ``trial`` holds trial 1.

    Raises
    ------
    DataError
        If a needed column is missing, a value is not a number, time does not rise within a trial, a trial has
        fewer than two samples, or two signals differ in their number of joints.
    """
    columns = read_columns(path)
    _require(columns, ["t", *(f"{name}1" for name in needed)], path)
    signals = {name: joint_columns(columns, name) for name in (*needed, *optional)}
    found = {"t": columns["t"][:, None]} | {name: rows for name, rows in signals.items() if rows is not None}
    for name, rows in found.items():
        bad = np.argwhere(~np.isfinite(rows))
        if bad.size:
            row, joint = bad[0]
            column = name if name == "t" else f"{name}{joint + 1}"
            raise DataError(f"{path}: {column} is not a finite number in row {row + 1}")
    joints = {name: rows.shape[1] for name, rows in found.items() if name != "t"}
    if len(set(joints.values())) > 1:
        raise DataError(f"{path}: its columns are for different numbers of joints ({joints}), expected one")
    return {
        number: _one_trial({name: array[rows] for name, array in found.items()}, rows + 1, number, path)
        for number, rows in _rows_by_trial(columns, path).items()
    }


def _require(columns: Columns, names: Sequence[str], path: Path) -> None:
    missing = [name for name in names if name not in columns]
    if missing:
        there = ", ".join(columns) or "none"
        raise DataError(f"{path}: no column {', '.join(missing)} among its columns ({there})")


def _rows_by_trial(columns: Columns, path: Path) -> dict[int, np.ndarray]:
    trials = columns.get("trial", np.ones(len(columns["t"])))
    odd = np.flatnonzero(~(np.isfinite(trials) & (trials == np.floor(trials))))
    if odd.size:
        raise DataError(f"{path}: trial is {trials[odd[0]]} in row {odd[0] + 1}, expected a whole number")
    if not trials.size:
        raise DataError(f"{path}: there are no rows")
    return {int(number): np.flatnonzero(trials == number) for number in np.unique(trials)}


def _one_trial(signals: Signals, row_numbers: np.ndarray, number: int, path: Path) -> Signals:
    t = signals.pop("t")[:, 0]
    if len(t) < 2:
        raise DataError(f"{path}: trial {number} has {len(t)} sample, expected at least 2")
    backwards = np.flatnonzero(np.diff(t) <= 0.0)
    if backwards.size:
        k = backwards[0]
        found = f"t goes from {t[k]:.9g} to {t[k + 1]:.9g} s in row {row_numbers[k + 1]} (trial {number})"
        raise DataError(f"{path}: {found}, expected rising time")
    return {"t": t - t[0], **signals}
