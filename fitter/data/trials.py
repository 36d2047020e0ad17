"""Trials: one motion each, on a uniform grid, with every derivative that a fit needs."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arm.drive_state import DriveState
from arm.model import Arm
from fitter.data.bandwidth import Signal, motion_edge_hz
from fitter.data.derivatives import differentiate, lowpass, settling_samples
from fitter.data.drives import drives_of, let_go
from fitter.data.jumps import midway_at_jumps
from fitter.data.motions import Measured, read_motions
from fitter.data.plausibility.questions import questioned
from fitter.data.plausibility.saturated import CONTRADICTED
from fitter.data.recordings import read_frames
from fitter.data.resample import Uniform, resample, split_at_holes
from limbcal.errors import ConfigError, DataError
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES, parse_mapping
from protocol.tables.files import RECORDINGS, expand
from tracking.draws import Draws

Floats = NDArray[np.float64]
Role = Literal["learn", "evaluate"]

#: Derived columns are cut off this far above the edge of the motion, so that nothing of the motion is lost.
COLUMN_CORNER = 1.5
#: A fit is cut off this far below that, so that hardly anything but motion is left.
FIT_CORNER = 2.0 / 3.0 / COLUMN_CORNER
#: At most this share of a trial is trimmed at each end, and a corner needs this many periods in a trial.
TRIM_SHARE = 0.1
#: A sample of a new grid is contradicted if any share of it comes from such a one, but for rounding.
_ANY = 1e-3


@dataclass(frozen=True)
class Trial:
    """One motion.

    Attributes
    ----------
    name : str
        File and trial.
    t : ndarray of shape (n,)
        Time [s], from 0 on a uniform grid.
    dt_s : float
        Step of the grid [s].
    q, dq, ddq : ndarray of shape (n, n_joint)
        Joint angles [rad] (or m) and their derivatives.
    tau, ref : ndarray of shape (n, n_joint), or None
        Torque [N·m] (or N) and the controller's target, where there are any.
    tip : ndarray of shape (n, 3), or None
        Measured tip [m].
    notes : tuple of Note
        What was resampled, derived, trimmed.
    cutoff_hz : float
        Corner chosen for columns that were derived; infinite if nothing is to be filtered.
    band_hz : float
        Corner of `lowpass`.
    points : ndarray of shape (n, n_sensor, 3), or None
        Dead-reckoned sensor positions [m], from recordings.
    role : str, optional
        "learn" or "evaluate", where a recording says so.
    ref_filtered : ndarray of shape (n, n_joint), or None
        The target behind the filter that q, dq and ddq passed, if they passed one: what stands beside them in the
        law's torque. A simulation is given ``ref`` itself, which is known exactly.
    tau_measured : ndarray of shape (n, n_joint), or None
        The torque as it was measured, on the same grid, before any filter: what a simulation is to be judged by.
    whole : dict from name to ndarray of shape (n + 2 * trimmed, n_joint)
        Angles, target and torque as they were measured, unfiltered, ends included: what a simulation is fitted
        to, with nothing but its own noise in it. Empty where the derivatives came with the motion.
    trimmed : int
        Samples that were taken off at each end.
    began_s : float
        The file's time at ``t = 0`` [s]: trials may follow one another on one clock.
    contradicted : ndarray of bool, shape (n, n_joint), or None
        Torques that say nothing of the arm: cut off at a limit, or beside an angle that stood still for no reason;
        see `fitter.data.plausibility`.
    drives : arm.drive_state.DriveState, or None
        Where the drives are engaged, and gains of the trial's own, on the same grid; None where the arm's law says
        all. Their columns ``on kp kv`` are then in ``whole`` too. A drive that is let go gives no torque.
    draws : tracking.draws.Draws, or None
        The motion as it may have been, where its tracker says so; of its points those of the tip's sensor. Each
        sample then stands for a step of the readings that it was found from, and one that an acceleration jumps in
        for none.
    """

    name: str
    t: Floats
    dt_s: float
    q: Floats
    dq: Floats
    ddq: Floats
    tau: Floats | None = None
    ref: Floats | None = None
    tip: Floats | None = None
    notes: tuple[Note, ...] = ()
    cutoff_hz: float = np.inf
    band_hz: float = np.inf
    points: Floats | None = None
    role: str | None = None
    ref_filtered: Floats | None = None
    tau_measured: Floats | None = None
    whole: dict[str, Floats] = field(default_factory=dict)
    trimmed: int = 0
    began_s: float = 0.0
    contradicted: NDArray[np.bool_] | None = None
    draws: Draws | None = None
    drives: DriveState | None = None

    @property
    def counted(self) -> NDArray[np.bool_]:
        """Which torques count, (n, n_joint): all that the data itself does not contradict."""
        return np.ones(self.q.shape, dtype=bool) if self.contradicted is None else ~self.contradicted

    def lowpass(self, values: Floats) -> Floats:
        """Pass something that was computed from this trial through the one filter of a fit.

        What stands on both sides of an equation must be filtered alike: regressor and torque. With the regressor
        filtered, not only the angles that go into it, the equation stays exact, Coulomb friction included.

        Parameters
        ----------
        values : ndarray of shape (n, …)
            One row a sample of this trial, or of a stretch of it.

        Returns
        -------
        ndarray of the same shape
            Low-passed at `band_hz` with zero phase. Its ends are mirrored, which is a linear guess like the filter
            itself, so the equation holds there too.
        """
        return lowpass(values, self.dt_s, self.band_hz, ends="even")


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
) -> list[Trial]:
    """Read a set of trials.

    A file is one trial, or several if it has a column ``trial``, cells (``.mat``) or announced motions
    (recordings). Missing derivatives are computed without a phase shift; then every measured column of the trial
    passes the same filter and the ends are trimmed. Derivatives that are there are used as they are.

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
        Whose motion the files say they hold: they are questioned, see `fitter.data.plausibility`.

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
    for name, corner in (("cutoff_hz", cutoff_hz), ("band_hz", band_hz)):
        if corner is not None and not corner > 0.0:
            raise ConfigError(f"{name} is {corner}, expected a number above 0")
    mapping = parse_mapping(columns, n_joint)
    motions: list[Measured] = []
    files = expand(sources)
    for path in files:
        if path.suffix.lower() in RECORDINGS:
            motions += [motion for motion in read_frames(path, n_joint) if role in (None, motion.role)]
        else:
            read = read_motions(path, n_joint, mapping, rate_hz, required=("q",))
            motions += read if arm is None else questioned(read, arm)
    if not motions:
        raise DataError(f"{', '.join(map(str, files))}: no trial with role {role!r} in it")
    return to_trials(motions, rate_hz, cutoff_hz, band_hz)


def to_trials(
    motions: Sequence[Measured],
    rate_hz: float | None = None,
    cutoff_hz: float | None = None,
    band_hz: float | None = None,
) -> list[Trial]:
    """Put motions on uniform grids and fill in what a fit needs; parameters as for `load_trials`."""
    uniform = [resample(piece, rate_hz) for motion in motions for piece in split_at_holes(motion)]
    cutoff_hz = choose_cutoff_hz(uniform) if cutoff_hz is None else cutoff_hz
    longest_s = max((len(motion.measured.t) * motion.dt_s for motion in uniform), default=np.inf)
    if cutoff_hz < 1.0 / longest_s:
        raise ConfigError(
            f"cutoff_hz is {cutoff_hz:g}, expected at least {1.0 / longest_s:.3g}: one period in the longest trial"
        )
    band_hz = FIT_CORNER * cutoff_hz if band_hz is None else band_hz
    return [derive(motion, cutoff_hz, band_hz) for motion in uniform]


def choose_cutoff_hz(motions: Sequence[Uniform]) -> float:
    """Return the corner [Hz] of a filter that keeps all motion that stands out from noise, or infinity."""
    edge = motion_edge_hz([_signal(motion) for motion in motions])
    if edge is None:
        return np.inf
    usual_s = float(np.median([len(motion.measured.t) * motion.dt_s for motion in motions]))
    return max(COLUMN_CORNER * edge, 1.0 / (TRIM_SHARE * usual_s))


def lowpass_trial(trial: Trial, cutoff_hz: float) -> Trial:
    """Return a trial all of whose columns passed one zero-phase filter, without the ends that rest on a guess.

    Parameters
    ----------
    trial : Trial
        What to filter.
    cutoff_hz : float
        Corner frequency.

    Returns
    -------
    Trial
        Its time starts at 0 again; its `lowpass` does nothing more.
    """
    trim = _trim(len(trial.t), trial.dt_s, cutoff_hz)
    inner = slice(trim, len(trial.t) - trim)

    def filtered(values: Floats | None) -> Floats | None:
        return None if values is None else lowpass(values, trial.dt_s, cutoff_hz)[inner]

    return replace(
        trial,
        t=trial.t[: len(trial.t) - 2 * trim],
        q=lowpass(trial.q, trial.dt_s, cutoff_hz)[inner],
        dq=lowpass(trial.dq, trial.dt_s, cutoff_hz)[inner],
        ddq=lowpass(trial.ddq, trial.dt_s, cutoff_hz)[inner],
        tau=filtered(trial.tau),
        ref=filtered(trial.ref),
        ref_filtered=filtered(trial.ref_filtered),
        tip=filtered(trial.tip),
        points=filtered(trial.points),
        tau_measured=None if trial.tau_measured is None else trial.tau_measured[inner],
        contradicted=None if trial.contradicted is None else trial.contradicted[inner],
        drives=None if trial.drives is None else trial.drives.rows(inner),
        trimmed=trial.trimmed + trim,
        began_s=trial.began_s + trim * trial.dt_s,
        cutoff_hz=np.inf,
        band_hz=np.inf,
        notes=(*trial.notes, Note("filtered", f"all columns low-passed at {cutoff_hz:.4g} Hz (zero phase)")),
    )


def undriven(trial: Trial) -> Trial:
    """Return a trial as of an arm that swings freely: its torque is known, and zero."""
    zero = np.zeros_like(trial.q)
    whole = {name: values for name, values in trial.whole.items() if name not in DRIVE_ROLES}
    whole |= {"tau": np.zeros_like(whole["q"])} if whole else {}
    return replace(trial, tau=zero, tau_measured=zero, ref=None, ref_filtered=None, drives=None, whole=whole)


def _signal(motion: Uniform) -> Signal:
    """Return the column that is nearest to an acceleration."""
    columns = motion.measured.columns
    for missing, name in enumerate(("ddq", "dq")):
        if name in columns:
            return Signal(columns[name], motion.dt_s, missing)
    return Signal(columns["q"], motion.dt_s, 2)


def derive(motion: Uniform, cutoff_hz: float, band_hz: float) -> Trial:
    """Fill in what a motion on a uniform grid lacks, and filter all columns alike if anything was."""
    measured, dt_s = motion.measured, motion.dt_s
    columns, said = let_go(measured.columns, measured.where)
    drives = drives_of(columns)
    given = {name: values for name, values in columns.items() if name not in (CONTRADICTED, *DRIVE_ROLES)}
    marked = columns.get(CONTRADICTED)
    notes = [*measured.notes, *said]
    derived = [name for name in ("dq", "ddq") if name not in given]
    trim = 0
    kept_whole = ("q", "ref", "tau", *(() if drives is None else DRIVE_ROLES))
    whole = {name: columns[name] for name in kept_whole if name in columns}
    if "tau" in whole:
        whole["tau"] = midway_at_jumps(whole["tau"])
    if derived:
        given |= {name: whole[name] for name in ("tau",) if name in whole}
        trim = _trim(len(measured.t), dt_s, cutoff_hz)
        reference = given.pop("ref", None)  # a command is known exactly
        given = {name: lowpass(values, dt_s, cutoff_hz) for name, values in given.items()}
        if reference is not None:
            # A target is held from one sample to the next, so it comes half a step late as seen by the samples.
            held = (reference + np.vstack([reference[:1], reference[:-1]])) / 2
            given |= {"ref": reference, "ref_filtered": lowpass(held, dt_s, cutoff_hz)}
        source = "dq" if "dq" in given else "q"
        if "dq" not in given:
            given["dq"] = differentiate(given["q"], dt_s)
        if "ddq" not in given:
            given["ddq"] = differentiate(given[source], dt_s, 1 if source == "dq" else 2)
        filtered = "unfiltered" if trim == 0 else f"all columns but ref low-passed at {cutoff_hz:.4g} Hz"
        notes.append(Note("derived", f"{', '.join(derived)} derived from {source} (zero phase, {filtered})"))
    if trim:
        notes.append(Note("trimmed", f"{trim * dt_s:.3g} s trimmed at each end"))
    inner = slice(trim, len(measured.t) - trim)
    tau_measured = columns["tau"][inner] if "tau" in columns else None
    kept = {name: values[inner] for name, values in given.items()}
    return Trial(
        name=measured.name,
        t=measured.t[: len(measured.t) - 2 * trim],
        dt_s=dt_s,
        q=kept["q"],
        dq=kept["dq"],
        ddq=kept["ddq"],
        tau=kept.get("tau"),
        ref=kept.get("ref"),
        tip=kept.get("tip"),
        notes=tuple(notes),
        cutoff_hz=cutoff_hz,
        band_hz=band_hz,
        points=kept.get("points"),
        role=measured.role,
        ref_filtered=kept.get("ref_filtered"),
        tau_measured=tau_measured,
        whole=whole if derived else {},
        trimmed=trim,
        began_s=motion.began_s + trim * dt_s,
        contradicted=None if marked is None else marked[inner] > _ANY,
        drives=None if drives is None else drives.rows(inner),
    )


def _trim(n: int, dt_s: float, cutoff_hz: float) -> int:
    return min(settling_samples(dt_s, cutoff_hz), int(TRIM_SHARE * n))
