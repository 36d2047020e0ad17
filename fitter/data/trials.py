"""Files, folders and recordings to trials."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from arm.model import Arm
from fitter.data.derived_trial import derive
from fitter.data.estimated_again import recorded_motions
from fitter.data.motions import Measured, read_motions
from fitter.data.plausibility.questions import questioned
from fitter.data.recordings import by_run, read_frames
from fitter.data.resample import resample, split_at_holes
from fitter.data.trial import Role, Trial
from fitter.data.trial_filter import FIT_CORNER, choose_cutoff_hz
from limbcal.errors import ConfigError, DataError
from protocol.tables.columns import parse_mapping
from protocol.tables.files import RECORDINGS, expand


def load_trials(
    sources: Sequence[Path],
    n_joint: int,
    columns: str | None = None,
    *,
    rate_hz: float | None = None,
    cutoff_hz: float | None = None,
    band_hz: float | None = None,
    role: Role | None = None,
    arm: Arm | None = None,
    as_tracked: bool = False,
) -> list[Trial]:
    """Read a set of trials, see `read_set` and `to_trials`.

    A file is one trial, or several if it has a column ``trial``, cells (``.mat``) or announced motions
    (recordings, those of one run read as one). Missing derivatives are computed without a phase shift; then every
    measured column of the trial passes the same filter and the ends are trimmed. Derivatives that are there are
    used as they are.

    Parameters
    ----------
    sources : sequence of Path
        Files and folders: CSV, Parquet, NPZ, ``.mat``, ``.json``, ``.mcap``.
    n_joint : int
        Number of joints of the arm.
    columns : str, optional
        Mapping of foreign columns, see `protocol.tables.columns.parse_mapping`.
    rate_hz : float, optional
        Rate to resample to, and the rate of the samples where a file has no time. Default: the files' own.
    cutoff_hz : float, optional
        Corner of the filter that derived columns pass. Default: half as high again as the frequency at which
        the acceleration sinks into noise, found in the spectra of the whole set, see `fitter.data.bandwidth`. Give
        evaluating trials the ``cutoff_hz`` of the learning ones; infinity switches the filter off.
    band_hz : float, optional
        Corner of `Trial.lowpass`. Default: 4/9 of ``cutoff_hz``, which is two thirds of that frequency.
    role : {"learn", "evaluate"}, optional
        From recordings, take only trials of this role. Trials of other files have none and are all taken.
    arm : Arm, optional
        Whose motion the files say they hold: they are questioned, see `fitter.data.plausibility`. Motions of
        recordings are estimated again from their readings, see `fitter.data.estimated_again`.
    as_tracked : bool
        Take the motions of recordings as the tracker gave them out instead.

    Returns
    -------
    list of Trial
        In the order of files, folders and rows.

    Raises
    ------
    ConfigError
        If the mapping or a rate is wrong.
    DataError
        If a file cannot be read or used: one sentence with file, column and row.
    """
    motions = read_set(sources, n_joint, columns, rate_hz=rate_hz, arm=arm, as_tracked=as_tracked)
    chosen = [motion for motion in motions if role in (None, motion.role) or motion.role is None]
    if not chosen:
        raise DataError(f"{', '.join(map(str, sources))}: no trial with role {role!r} in it")
    return to_trials(chosen, rate_hz, cutoff_hz, band_hz)


def read_set(
    sources: Sequence[Path],
    n_joint: int,
    columns: str | None = None,
    *,
    rate_hz: float | None = None,
    arm: Arm | None = None,
    as_tracked: bool = False,
) -> list[Measured]:
    """Read the motions of a set as they were measured; parameters as for `load_trials`."""
    mapping = parse_mapping(columns, n_joint)
    motions: list[Measured] = []
    for together in by_run(expand(sources)):
        path = together[0]
        if path.suffix.lower() in RECORDINGS:
            motions += (
                read_frames(together, n_joint) if arm is None else recorded_motions(together, arm, as_tracked)
            )
        else:
            read = read_motions(path, n_joint, mapping, rate_hz, required=("q",))
            motions += read if arm is None else questioned(read, arm)
    return motions


def to_trials(
    motions: Sequence[Measured],
    rate_hz: float | None = None,
    cutoff_hz: float | None = None,
    band_hz: float | None = None,
) -> list[Trial]:
    """Put motions on uniform grids and fill in what a fit needs; parameters as for `load_trials`."""
    for name, corner in (("cutoff_hz", cutoff_hz), ("band_hz", band_hz)):
        if corner is not None and not corner > 0.0:
            raise ConfigError(f"{name} is {corner}, expected a number above 0")
    uniform = [resample(piece, rate_hz) for motion in motions for piece in split_at_holes(motion)]
    cutoff_hz = choose_cutoff_hz(uniform) if cutoff_hz is None else cutoff_hz
    require_period(cutoff_hz, max((len(motion.measured.t) * motion.dt_s for motion in uniform), default=np.inf))
    band_hz = FIT_CORNER * cutoff_hz if band_hz is None else band_hz
    return [derive(motion, cutoff_hz, band_hz) for motion in uniform]


def require_period(cutoff_hz: float, longest_s: float) -> None:
    """Raise a ConfigError where not even the longest trial of a set [s] holds a period of its filter's corner."""
    if cutoff_hz < 1.0 / longest_s:
        raise ConfigError(
            f"cutoff_hz is {cutoff_hz:g}, expected at least {1.0 / longest_s:.3g}: one period in the longest trial"
        )
