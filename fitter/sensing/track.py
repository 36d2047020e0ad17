"""A recording of raw accelerations, tracked from end to end."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from arm.kinematics import tip_position
from arm.model import Arm
from fitter.data.drift import dead_reckoned, without_drift
from fitter.data.measured_tip import measured_tip
from fitter.data.raw import RawRun
from fitter.sensing.followed import Followed, follow, smoothed
from fitter.sensing.verdict import Verdict
from limbcal.note import Note
from tracking.dead_reckoning.integrator import Zero
from tracking.model.frames import Phase
from tracking.model.zero_velocity import WINDOW_S
from tracking.tracker import tracker_of

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Method = Literal["integrate", "filter", "smooth"]

#: Of a recording so much shows whether it begins at rest [s]: that is asked of a quarter of a second, besides what
#: decimation needs.
_LOOKED_AT_S = 2.0 * WINDOW_S
#: Steps between true samples above which nothing is known of what lies between them.
_HOLE_SAMPLES = 1.5
#: An angle is held to be within this number of its own standard deviations.
_SIGMAS = 3.0


@dataclass(frozen=True)
class Tracked:
    """Joint motion that was tracked.

    Attributes
    ----------
    columns : dict of str to ndarray
        t [s] on the clock of the readings, q, dq, ddq, and ref where the readings had it; tip, measured: from
        where the arm file has it at first, moved by what the accelerations say; trial, by the readings' own
        labels or else by the rests that were recognised. By the filter and the smoother also q_std, how well the
        angles are known by their own claim, and gap, 1 where samples were lost and the frame was predicted.
    verdict : Verdict
        What the tracker says of itself.
    error_deg : ndarray of shape (n_scored, n_joint), or None
        How far each angle is from the true one in the frames beside whose times true angles are known: degrees, or
        mm for a sliding joint. None where there are none.
    within_3_std : ndarray of bool, shape (n_scored, n_joint), or None
        Whether that is at most three of its standard deviations, where the tracker claims any.
    notes : tuple of Note
        What there is to say about how the recording begins.
    """

    columns: dict[str, NDArray[np.generic]]
    verdict: Verdict
    error_deg: Floats | None
    within_3_std: Bools | None
    notes: tuple[Note, ...] = ()

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.columns["t"])

    @property
    def last_q(self) -> Floats:
        """Joint positions in the last frame, of shape (n_joint,)."""
        return np.asarray(self.columns["q"][-1], dtype=np.float64)


def track_run(
    run: RawRun,
    arm: Arm,
    initial_q_rad: Floats | None,
    frame_rate_hz: float,
    method: Method = "smooth",
    zero: Zero = "each-rest",
) -> Tracked:
    """Track one run of readings.

    Parameters
    ----------
    run : RawRun
    arm : Arm
    initial_q_rad : ndarray of shape (n_joint,), or None
        Where the arm rests at the first reading. Without it gravity is asked; where gravity doesn't show it, and
        by the paper's method, it is zero.
    frame_rate_hz : float
    method : {"integrate", "filter", "smooth"}
        The paper's, the Kalman filter, or the smoother, for which every reading counts at every instant.
    zero : {"each-rest", "first-rest"}
        Of the paper's method, see `tracking.dead_reckoning.integrator.Integrator`.

    Raises
    ------
    ConfigError
        If the arm's sensors cannot give its angles.
    """
    rate_hz, arm = min(frame_rate_hz, run.rate_hz), arm.with_gyroscopes(run.gyros)
    if method == "smooth":
        motion = smoothed(run, arm, initial_q_rad, rate_hz)
    else:
        motion = follow(run, tracker_of(arm, method, run.rate_hz, initial_q_rad, rate_hz, zero))
    notes = beginning(run, rate_hz, method)
    t, q = motion.t, motion.column("q")
    columns: dict[str, NDArray[np.generic]] = {"t": t}
    columns |= {name: motion.column(name) for name in ("q", "dq", "ddq")}
    q_std = motion.q_std
    if q_std is not None:
        columns["q_std"] = q_std
        if run.gaps:
            columns["gap"] = motion.predicted(run).astype(np.int64)
    if arm.tip is not None:
        columns["tip"] = _tip(arm, motion, method)
    row = np.clip(np.searchsorted(run.t, t, side="right") - 1, 0, len(run.t) - 1)
    if run.ref is not None:
        columns["ref"] = run.ref[row]
    if run.trial is not None:
        columns["trial"] = run.trial[row]
    else:
        columns["trial"], notes = trials_of(t, motion.phases), (*notes, *parted(motion.phases))
    true = true_angles(run, t)
    known = np.zeros(len(t), dtype=np.bool_) if true is None else np.isfinite(true).all(axis=1)
    if true is None or not known.any():
        return Tracked(columns, motion.verdict, None, None, notes)
    error = np.abs(q - true)[known]
    unit = np.array([180.0 / np.pi if joint.type == "revolute" else 1e3 for joint in arm.joints])
    within = None if q_std is None else error <= _SIGMAS * q_std[known]
    return Tracked(columns, motion.verdict, error * unit, within, notes)


def beginning(run: RawRun, frame_rate_hz: float, method: Method) -> tuple[Note, ...]:
    """Return what there is to say where a recording begins in the middle of a motion."""
    rows = math.ceil(_LOOKED_AT_S * run.rate_hz)
    first = replace(
        run,
        t=run.t[:rows],
        a=run.a[:rows],
        w=None if run.w is None else run.w[:rows],
        gaps=tuple(gap for gap in run.gaps if gap.row < rows),
    )
    seen = first.readings(frame_rate_hz)
    if method == "smooth":  # it judges by the noise of all readings
        seen = replace(seen, noise=run.readings(frame_rate_hz).noise)
    if not seen.begins_in_motion:
        return ()
    text = "it begins in the middle of a motion: "
    if method == "smooth":
        text += "how fast the arm was and where is learnt from what follows"
    else:
        text += f"--method {method} begins at rest, do not rely on its angles; expected --method smooth, or a rest"
    return (Note("moving", text, from_s=float(run.t[0])),)


def parted(phases: list[Phase]) -> tuple[Note, ...]:
    """Return what there is to say where rests part a recording without labels into trials."""
    motions = sum(phase.kind == "begin" for phase in phases)
    if motions < 2:
        return ()
    return (Note("parted", f"trials parted by rests: {motions} motions, each with the rest before it"),)


def true_angles(run: RawRun, t: Floats) -> Floats | None:
    """Return the true angles at some times (n,), those of cubic splines: (n, n_joint); None where none are known.

    Where the samples beside a time are not there, its row is NaN: what was lost is not drawn through.
    """
    if run.q is None:
        return None
    there = np.isfinite(run.q).all(axis=1)
    clock, q = run.t[there], run.q[there]
    holes = np.flatnonzero(np.diff(clock) > _HOLE_SAMPLES / run.rate_hz) + 1
    true, half = np.full((len(t), q.shape[1]), np.nan), 0.5 / run.rate_hz
    for own, values in zip(np.split(clock, holes), np.split(q, holes), strict=True):
        if len(own) > 1:
            inside = (t >= own[0] - half) & (t <= own[-1] + half)
            true[inside] = scipy.interpolate.CubicSpline(own, values)(t[inside])
    return true


def trials_of(t: Floats, phases: list[Phase]) -> NDArray[np.int64]:
    """Return each frame's motion: from the end of the one before to its own end; the last takes what follows.

    Parameters
    ----------
    t : ndarray of shape (n,)
        Times [s].
    phases : list of Phase

    Returns
    -------
    ndarray of shape (n,)
        From 1.
    """
    ends = np.array([1e-9 * phase.t_ns for phase in phases if phase.kind == "end"])
    motions = max(1, sum(phase.kind == "begin" for phase in phases))
    return np.minimum(np.searchsorted(ends, t, side="right") + 1, motions)


def _tip(arm: Arm, motion: Followed, method: Method) -> Floats:
    points = {"points": motion.column("points")}
    points = without_drift(motion.t, points, motion.motions, dead_reckoned(method))
    q = motion.column("q")
    moved = measured_tip(arm, q, points["points"])
    tip: Floats = tip_position(arm, q[:1]) + moved - moved[0]
    return tip
