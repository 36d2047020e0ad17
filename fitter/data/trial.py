"""A trial: one motion on a uniform grid, with every derivative that a fit needs."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from arm.drive_state import DriveState
from arm.effects.trials import TrialId, trial_id
from fitter.data.derivatives import lowpass
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES
from tracking.model.draws import Draws

Floats = NDArray[np.float64]
Role = Literal["learn", "evaluate"]


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
        The target behind the filter that q, dq and ddq passed, if they passed one: what stands next to them in the
        law's torque. A simulation is given ``ref`` itself, which is known exactly.
    tau_measured : ndarray of shape (n, n_joint), or None
        The torque as it was measured, on the same grid, before any filter: what a simulation is to be judged by.
    whole : dict from name to ndarray of shape (n + 2 * trimmed, n_joint)
        All columns as they were measured, unfiltered, ends included: what a simulation is fitted to, with nothing
        but its own noise in it. Empty where the derivatives came with the motion.
    trimmed : int
        Samples that were taken off at each end.
    began_s : float
        The file's time at ``t = 0`` [s]: trials may follow one another on one clock.
    number : int
        Which of the run's trials this is, from 1, those learnt from first.
    contradicted : ndarray of bool, shape (n, n_joint), or None
        Torques that say nothing of the arm: cut off at a limit, or next to an angle that stood still for no
        reason; see `fitter.data.plausibility`.
    drives : arm.drive_state.DriveState, or None
        Where the drives are engaged, and gains of the trial's own, on the same grid; None where the arm's law says
        all. Their columns ``on kp kv`` are then in ``whole`` too. A drive that is let go gives no torque.
    draws : tracking.model.draws.Draws, or None
        The motion as it may have been, where its tracker says so; of its points those of the tip's sensor. Each
        sample then stands for a step of the readings that it was found from, and one that an acceleration jumps in
        for none.
    label : str
        What stands in its ``trial`` column; nothing without one.
    piece_of : str
        The name of the trial that it is a piece of, if that was parted.
    target_std : (n_joint,) [N m or N], or None
        Where nobody recorded ``ref`` and it is the target that a calibrated arm explains the motion with: standard
        deviation of the constant torque by which it is off, taken to be that of what varies beside it.
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
    number: int = 1
    contradicted: NDArray[np.bool_] | None = None
    draws: Draws | None = None
    drives: DriveState | None = None
    label: str = ""
    piece_of: str = ""
    target_std: Floats | None = None

    @property
    def identity(self) -> TrialId:
        """What effects call it: a piece is called as its trial is."""
        return trial_id(self.number, self.label, self.piece_of or self.name)

    @property
    def counted(self) -> NDArray[np.bool_]:
        """Which torques count, (n, n_joint): all that the data itself does not contradict."""
        return np.ones(self.q.shape, dtype=bool) if self.contradicted is None else ~self.contradicted

    @property
    def tracked(self) -> bool:
        """Whether a tracker made it from accelerations: what it drifts by is wrong for the whole motion."""
        return self.points is not None

    @property
    def n_independent(self) -> float:
        """Independent samples of a joint: behind a filter two a period of its corner."""
        return 2.0 * min(self.band_hz, 0.5 / self.dt_s) * len(self.q) * self.dt_s

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


def is_driven(trials: Sequence[Trial]) -> bool:
    """Whether a torque was measured, or a law gives one: false where all arms swing freely."""
    return any(trial.tau is None or bool(np.any(trial.tau)) for trial in trials)


def undriven(trial: Trial) -> Trial:
    """Return a trial as of an arm that swings freely: its torque is known, and zero."""
    zero = np.zeros_like(trial.q)
    whole = {name: values for name, values in trial.whole.items() if name not in DRIVE_ROLES}
    whole |= {"tau": np.zeros_like(whole["q"])} if whole else {}
    return replace(trial, tau=zero, tau_measured=zero, ref=None, ref_filtered=None, drives=None, whole=whole)
