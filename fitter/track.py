"""A recording of raw accelerations, tracked from end to end."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from arm.kinematics import tip_position
from arm.model import Arm
from fitter.drift import without_drift
from fitter.measured_tip import measured_tip
from fitter.raw import RawRun
from tracking.frames import Frames, Phase
from tracking.integrator import Integrator, Zero

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Tracked:
    """Joint motion that was tracked.

    Attributes
    ----------
    columns : dict of str to ndarray
        t [s] on the clock of the readings, q, dq, ddq, and ref where the readings had it; tip, measured: from
        where the arm file has it at first, moved by what the accelerations say; trial, by the readings' own
        labels or else by the rests that were recognised.
    error_deg : ndarray of shape (n, n_joint), or None
        How far each angle is from the true one, where the readings come with it: degrees, or mm for a sliding
        joint.
    """

    columns: dict[str, NDArray[np.generic]]
    error_deg: Floats | None

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.columns["t"])


def track_run(run: RawRun, arm: Arm, initial_q_rad: Floats, frame_rate_hz: float, zero: Zero) -> Tracked:
    """Track one run of readings by the paper's method.

    Parameters
    ----------
    run : RawRun
    arm : Arm
    initial_q_rad : ndarray of shape (n_joint,)
        Where the arm rests at the first reading.
    frame_rate_hz : float
    zero : {"each-rest", "first-rest"}
        See `tracking.integrator.Integrator`.

    Raises
    ------
    ConfigError
        If the arm's sensors cannot give its angles.
    """
    tracker = Integrator(arm, run.rate_hz, initial_q_rad, min(frame_rate_hz, run.rate_hz), zero)
    frames: list[Frames] = []
    phases: list[Phase] = []
    for block in run.blocks():
        if block.lost:
            _extend(frames, phases, tracker.gap(block.lost))
        _extend(frames, phases, tracker.push(block.t0_ns, block.a))
    _extend(frames, phases, tracker.flush())
    t = np.concatenate([1e-9 * f.t0_ns + f.dt_s * np.arange(f.n) for f in frames])
    columns: dict[str, NDArray[np.generic]] = {
        "t": t,
        "q": np.concatenate([f.q for f in frames]),
        "dq": np.concatenate([f.dq for f in frames]),
        "ddq": np.concatenate([f.ddq for f in frames]),
    }
    if arm.tip is not None:
        columns["tip"] = _tip(arm, t, frames, phases)
    row = np.clip(np.searchsorted(run.t, t, side="right") - 1, 0, len(run.t) - 1)
    if run.ref is not None:
        columns["ref"] = run.ref[row]
    columns["trial"] = run.trial[row] if run.trial is not None else trials_of(t, phases)
    return Tracked(columns, None if run.q is None else _error(run, arm, t, frames))


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


def _tip(arm: Arm, t: Floats, frames: list[Frames], phases: list[Phase]) -> Floats:
    times = [1e-9 * phase.t_ns for phase in phases]
    motions = list(zip(times[0::2], times[1::2], strict=False))
    points = without_drift(t, {"points": np.concatenate([f.points for f in frames])}, motions)["points"]
    q = np.concatenate([f.q for f in frames])
    moved = measured_tip(arm, q, points)
    tip: Floats = tip_position(arm, q[:1]) + moved - moved[0]
    return tip


def _extend(frames: list[Frames], phases: list[Phase], new: tuple[list[Frames], list[Phase]]) -> None:
    frames += new[0]
    phases += new[1]


def _error(run: RawRun, arm: Arm, t: Floats, frames: list[Frames]) -> Floats:
    assert run.q is not None
    truth = np.column_stack([np.interp(t, run.t, run.q[:, j]) for j in range(arm.n_joint)])
    unit = np.array([180.0 / np.pi if joint.type == "revolute" else 1e3 for joint in arm.joints])
    error: Floats = np.abs(np.concatenate([f.q for f in frames]) - truth) * unit
    return error
