"""References that a simulated arm is to follow."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fitter.columns import parse_mapping
from fitter.motions import read_motions
from fitter.resample import resample
from fitter.sources import expand

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Reference:
    """What the controller is told.

    Attributes
    ----------
    name : str
        File and trial.
    t : ndarray of shape (n,)
        Time [s], from 0 on a uniform grid.
    dt_s : float
        Step of the grid [s].
    ref : ndarray of shape (n, n_joint)
        The controller's target [rad or m].
    q, dq : ndarray of shape (n, n_joint), or None
        Motion that stands beside it; its first row says where the arm starts.
    notes : tuple of str
        What was done to it.
    """

    name: str
    t: Floats
    dt_s: float
    ref: Floats
    q: Floats | None = None
    dq: Floats | None = None
    notes: tuple[str, ...] = ()


def load_references(
    sources: Sequence[Path], n_joint: int, columns: str | None = None, *, rate_hz: float | None = None
) -> list[Reference]:
    """Read references from CSV, Parquet, NPZ, ``.mat`` or ``.json``; see `fitter.trials.load_trials`.

    Raises
    ------
    ConfigError
        If the mapping or the rate is wrong.
    DataError
        If a file cannot be read or has no ``ref``.
    """
    mapping = parse_mapping(columns, n_joint)
    references: list[Reference] = []
    for path in expand(sources):
        for motion in read_motions(path, n_joint, mapping, rate_hz, required=("ref",)):
            uniform = resample(motion, rate_hz)
            measured = uniform.measured
            references.append(
                Reference(
                    measured.name,
                    measured.t,
                    uniform.dt_s,
                    measured.columns["ref"],
                    measured.columns.get("q"),
                    measured.columns.get("dq"),
                    measured.notes,
                )
            )
    return references
