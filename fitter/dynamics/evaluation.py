"""How well a calibrated arm moves and pulls like the real one (section 8.2)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from arm.drive_state import drives_of
from arm.effects.effect_table import changed
from arm.effects.resisting_torque import resisting_torque
from arm.model import Arm, Floats
from arm.newton_euler import inverse_dynamics
from arm.simulation import simulate
from fitter.data.derivatives import lowpass
from fitter.data.standstill import REST_SPEED
from fitter.data.torque_target import start_unknown, target_of, torque_target
from fitter.data.trial import Trial
from fitter.dynamics.shooting_windows import LONGEST_STEP_S, shooting_windows
from fitter.regression_sums.trial_sums import moving_all_along
from limbcal.errors import DataError

#: With measured torque nothing pulls a simulation back to the data, so it is restarted this often.
HORIZON_S = 0.5
#: A simulated joint that is this far off [rad or m] has run away: half a million turns.
_RUN_AWAY = 3e6


@dataclass(frozen=True)
class Score:
    """Errors of a calibrated arm over some trials.

    Attributes
    ----------
    torque_rms_N_m : tuple of float
        Of every joint: measured (or the law's) torque against that of eq. (4) for the same motion. N for a
        joint that slides.
    angle_mean_deg, angle_max_deg, angle_rms_deg : float
        Simulated against measured angles of all joints that turn. Infinite where a simulation ran away.
    explained : tuple of float
        Of every joint: 1 − power of the torque that remains / power of the torque that was to be explained, both
        behind the filter of the fit, while the joint moves. An arm of no mass and no friction explains 0; below
        0 the arm does worse than that. NaN where a joint never moved or had no torque.
    """

    torque_rms_N_m: tuple[float, ...]
    angle_mean_deg: float
    angle_max_deg: float
    angle_rms_deg: float
    explained: tuple[float, ...] = ()


def score(arm: Arm, trials: Sequence[Trial], horizon_s: float = HORIZON_S) -> Score:
    """Compare a calibrated arm with what was measured.

    Parameters
    ----------
    arm : Arm
    trials : sequence of Trial
    horizon_s : float
        With ``law = "measured"``, how long a simulation runs before it is restarted from the data.

    Raises
    ------
    DataError
        If there are no trials, or one lacks what drives it.
    """
    if not trials:
        raise DataError("no trial to compare the arm with; expected at least one")
    turning = np.array([joint.type == "revolute" for joint in arm.joints])
    errors = np.concatenate([np.abs(motion_error(arm, trial, horizon_s)) for trial in trials])[:, turning]
    mean, worst, rms = (float(np.rad2deg(f(errors))) if errors.size else np.nan for f in (np.mean, np.max, _rms))
    explained = tuple(torque_explained(arm, trials).tolist())
    return Score(tuple(torque_rms(arm, trials).tolist()), mean, worst, rms, explained)


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def explained_torque(arm: Arm, trial: Trial, u: Floats) -> Floats:
    """Return the torque that an arm needs for a trial's motion: eq. (4), and its effects at the joints.

    Parameters
    ----------
    arm : Arm
    trial : Trial
    u : (n_sample, n_joint) [N m or N]
        What drives the joints; what a drive makes of it, such as a delay, is not reckoned.
    """
    rigid = inverse_dynamics(changed(arm), trial.q, trial.dq, trial.ddq)
    if not arm.effects:
        return rigid
    t = trial.began_s + trial.t
    return rigid + resisting_torque(arm, trial.q, trial.dq, trial.ddq, u, t, trial.identity)


def torque_rms(arm: Arm, trials: Sequence[Trial]) -> Floats:
    """Return the rms of the torque that eq. (4) leaves unexplained, (n_joint,) [N m or N].

    A measured torque is taken as it was measured, unfiltered: its noise counts, as it does in anybody's figures.
    The torque of a law was never measured; both sides then pass the filter of their trial, as they did for the
    fit. A joint that stands still is omitted: any friction up to its static limit may hold it.
    """
    square, count = np.zeros((2, arm.n_joint))
    for trial in trials:
        law = arm.control.law != "measured"
        tau = torque_target(arm, replace(trial, ref=target_of(arm, trial)) if law else trial)
        explained = explained_torque(arm, trial, tau)
        if not law and trial.tau_measured is not None:
            residual = trial.tau_measured - explained
        else:
            residual = trial.lowpass(tau - explained)
        trim = (len(trial.dq) - len(residual)) // 2
        inner = slice(trim, len(trial.dq) - trim)
        moving = (trial.dq != 0.0) & trial.counted
        moving[start_unknown(arm, trial)] = False
        moving = moving[inner]
        square += np.sum(residual**2 * moving, axis=0)
        count += np.count_nonzero(moving, axis=0)
    return np.sqrt(square / np.maximum(count, 1.0))


def torque_explained(arm: Arm, trials: Sequence[Trial]) -> Floats:
    """Return what an arm explains of every joint's torque, (n_joint,); see `Score`."""
    residual_power, power = np.zeros((2, arm.n_joint))
    for trial in trials:
        law = arm.control.law != "measured"
        tau = torque_target(arm, replace(trial, ref=target_of(arm, trial)) if law else trial)
        counts = moving_all_along(trial, slice(0, len(trial.q)), REST_SPEED) & trial.counted
        counts[start_unknown(arm, trial)] = False  # such trials pass no filter that would spread it
        explained = explained_torque(arm, trial, tau)
        residual_power += np.sum(trial.lowpass(tau - explained) ** 2 * counts, axis=0)
        power += np.sum(trial.lowpass(tau) ** 2 * counts, axis=0)
    return 1.0 - residual_power / np.where(power > 0.0, power, np.nan)


def motion_error(arm: Arm, trial: Trial, horizon_s: float = HORIZON_S) -> Floats:
    """Return simulated minus measured joint angles.

    Under a control law the simulation starts from the trial's first state and runs to its end. Where the ends were
    trimmed by a filter, it runs through them too, and starts from the state that goes best with the angles as they
    were measured: what a filter says of the first instant is no state to start from; both then pass the filter.
    With measured torque it runs for ``horizon_s`` at a time, so every sample but the first is compared once.

    Returns
    -------
    (n_sample, n_joint) [rad or m]
        Infinite where the simulation ran away.
    """
    n = len(trial.q)
    if arm.control.law == "measured":
        torque = torque_target(arm, trial)
        simulated = trial.q.copy()
        stride = max(1, round(horizon_s / trial.dt_s))
        for start in range(0, n - 1, stride):
            window = slice(start, min(start + stride + 1, n))
            motion = simulate(
                arm,
                trial.q[window],
                trial.dt_s,
                trial.q[start],
                trial.dq[start],
                torque=torque[window],
                t0_s=trial.began_s + start * trial.dt_s,
                trial=trial.identity,
            )
            simulated[start + 1 : window.stop] = motion.q[1:]
    elif trial.trimmed and {"q", "ref"} <= set(trial.whole):
        q0, dq0 = best_start(arm, trial)
        begins_s = trial.began_s - trial.trimmed * trial.dt_s
        drives = drives_of(trial.whole)
        whole = simulate(
            arm, trial.whole["ref"], trial.dt_s, q0, dq0, t0_s=begins_s, trial=trial.identity, drives=drives
        ).q
        off = _or_infinite(whole) - trial.whole["q"]
        if not np.isfinite(off).all():
            return off[trial.trimmed : trial.trimmed + n]
        return lowpass(off, trial.dt_s, trial.cutoff_hz)[trial.trimmed : trial.trimmed + n]
    else:
        simulated = simulate(
            arm,
            target_of(arm, trial),
            trial.dt_s,
            trial.q[0],
            trial.dq[0],
            t0_s=trial.began_s,
            trial=trial.identity,
            drives=trial.drives,
        ).q
    return _or_infinite(simulated) - trial.q


def _or_infinite(simulated: Floats) -> Floats:
    return np.where(np.abs(simulated) < _RUN_AWAY, simulated, np.inf)


def best_start(arm: Arm, trial: Trial) -> Floats:
    """Return the first state of a whole trial, ends included, that the law turns into the measured motion.

    Parameters
    ----------
    arm : Arm
        With a control law.
    trial : Trial

    Returns
    -------
    (2, n_joint)
        Angles and velocities.
    """
    window = shooting_windows(arm, [trial], LONGEST_STEP_S)[0]

    def off(start: Floats) -> Floats:
        q0, dq0 = start.reshape(2, -1)
        q = simulate(
            arm,
            window.drive,
            window.dt_s,
            q0,
            dq0,
            t0_s=window.began_s,
            trial=trial.identity,
            drives=window.drives,
        ).q
        return np.nan_to_num(q - window.measured, nan=1e3, posinf=1e3, neginf=-1e3).ravel()

    found = scipy.optimize.least_squares(off, window.start[: 2 * arm.n_joint], max_nfev=20)
    return np.asarray(found.x, dtype=np.float64).reshape(2, -1)
