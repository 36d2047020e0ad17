"""The calibrated arm, simulated under its control law, as something to play."""

from pathlib import Path

import numpy as np

from arm.effects.trials import TrialId
from arm.model import Arm
from arm.possible import why_it_runs_away
from arm.trial_simulation import simulate_trial
from limbcal.errors import ConfigError, DataError
from playback.motion_trials import Signals, read_trials
from playback.source import Source
from playback.trajectory import Floats, Trajectory
from protocol.tables.columns import DRIVE_ROLES


def simulated_source(path: Path, arm: Arm, columns: str | None = None) -> Source:
    """Read the controller's targets and play what the arm makes of them.

    Each trial starts at rest where its first target is, or in the first state that the file gives in q1… and
    dq1…. A trial is simulated when it is loaded, with effects by the clock and the name that the file gives it.

    Parameters
    ----------
    path : Path
        A table with t [s], evenly spaced, ref1…refn [rad or m], and where known q1…, dq1…, on1…, kp1…,
        kv1…, trial.
    arm : Arm
        The arm with its control law.
    columns : str, optional
        Mapping of foreign columns.

    Raises
    ------
    DataError
        If the file cannot be used.
    ConfigError
        If the arm has no control law to simulate, or the mapping of columns is wrong.
    """
    if arm.control.law == "measured":
        raise ConfigError(
            f"arm {arm.name!r}: its control law is 'measured', whose torque comes with the data; "
            "expected 'pd', 'pda' or 'p' to simulate a reference"
        )
    found = read_trials(path, arm, needed=("ref",), optional=("q", "dq", *DRIVE_ROLES), columns=columns)
    trials = found.signals
    steps = {number: even_step(trial["t"], f"{path}: trial {number}") for number, trial in trials.items()}

    def trajectory(number: int) -> Trajectory:
        try:
            return simulated(arm, trials[number], steps[number], found.begins_s[number], found.identities[number])
        except DataError as error:  # an arm that no masses can have may run away to infinity
            raise DataError(f"{path}: trial {number}: in the simulation {error}") from error

    durations = {number: float(signals["t"][-1]) for number, signals in trials.items()}
    name = f"simulation of {arm.name} following {path.name}"
    return Source(name, arm, durations, trajectory, notes=found.notes, begins_s=found.stamps_s)


def simulated(arm: Arm, signals: Signals, dt_s: float, t0_s: float, trial: TrialId) -> Trajectory:
    """Return the motion of an arm that follows ``ref``, or that ``tau`` drives where its law is "measured".

    Parameters
    ----------
    arm : Arm
    signals : dict of str to ndarray
        As `arm.trial_simulation.simulate_trial` takes them, with ``q``, whose first row is where it starts, unless
        that is at the first target.
    dt_s, t0_s : float
        Step, and time of the first sample by the file's own clock, which effects go by.
    trial : TrialId

    Raises
    ------
    DataError
        If it runs away to infinity.
    """
    start = signals["q"] if "q" in signals else signals["ref"]
    motion = simulate_trial(arm, signals, dt_s, start[0], t0_s=t0_s, trial=trial)
    if not np.isfinite(motion.q).all():
        raise DataError(f"it runs away to infinity: {why_it_runs_away(arm)}")
    t = np.linspace(0.0, signals["t"][-1], len(signals["t"]))  # what was simulated, not what was printed
    return Trajectory(t, *motion.of_links, method="simulate")


def even_step(t: Floats, where: str) -> float:
    """Return the step of time that may be printed with few digits, but leaves no sample out.

    Raises
    ------
    DataError
        If it is not even.
    """
    dt = float(t[-1]) / (len(t) - 1)
    off = np.abs(t - dt * np.arange(len(t)))
    off[1:] = np.maximum(off[1:], np.abs(np.diff(t) - dt))
    worst = int(off.argmax())
    if off[worst] > 0.5 * dt:
        raise DataError(
            f"{where}: sample {worst + 1} is {off[worst]:.3g} s off an even step of {dt:.6g} s, "
            "expected evenly spaced time"
        )
    return dt
