"""Trials on the run's clock, and the same as hypothetical motions under some hypotheses.

A motion is a trial on the run's clock, with the drive's torque, and where friction is known. A hypothetical one
has another arm, angle or torque, and further columns.
"""

from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from arm.effects.joint_torque import N_STATE
from arm.effects.trials import TrialId
from arm.model import Arm, Floats
from arm.regressor import regressor
from arm.structural_parameters import structural_parameters
from fitter.data.law_torque import law_torque
from fitter.data.trial import Trial
from limbcal.errors import DataError

#: Samples a period of the corner that are kept of a motion.
SAMPLES = 5.0


@dataclass(frozen=True)
class Motion:
    """One trial of a run.

    Attributes
    ----------
    trial : Trial
    number : int
        From 1 over the run.
    learn : bool
        Whether it may be learnt from.
    t : (n_sample,) [s]
        The run's time.
    q, dq, ddq, u : (n_sample, n_joint)
        Angles, derivatives, and the torque that the drive was asked for.
    speed : (n_sample, n_joint)
        Velocity behind a filter that is quicker than that of dq: friction near rest changes within milliseconds.
    speed_noise : (n_sample, n_joint)
        Its rms noise, 0 where that is not known.
    direction : (n_sample, n_joint)
        -1, 0 or 1.
    stuck : (n_sample, n_joint) bool
        Where a joint stands still for a while: any torque up to its friction may hold it there.
    contradicted : (n_sample, n_joint) bool
        Where the data itself says that the torque tells nothing of the arm, see `fitter.data.trial.Trial`.
    dt_s : float
        Step of its grid: `SAMPLES` a period of the columns' corner are enough.
    jumps : tuple of (float, int, float)
        Jumps of the torque: sample, joint, and the standard error of its impulse, for its instant is not known
        exactly; as the torque of one sample [N m or N].
    """

    trial: Trial
    number: int
    learn: bool
    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    u: Floats
    speed: Floats
    speed_noise: Floats
    direction: Floats
    stuck: NDArray[np.bool_]
    contradicted: NDArray[np.bool_]
    dt_s: float
    jumps: tuple[tuple[float, int, float], ...] = ()

    @property
    def identity(self) -> TrialId:
        """What effects of an arm file call it."""
        return replace(self.trial, number=self.number).identity

    @property
    def unknown(self) -> NDArray[np.bool_]:
        """Where no equation holds for a joint's torque, (n_sample, n_joint)."""
        return self.stuck | self.contradicted

    @property
    def ahead_s(self) -> float:
        """By how much the run's clock is ahead of the trial's own [s]."""
        return float(self.t[0] - self.trial.t[0]) - self.trial.began_s


def drive_torque(arm: Arm, trial: Trial) -> Floats:
    """Return the torque that the drive was asked for: measured, or by the law, eq. (5), (6), (7).

    Raises
    ------
    DataError
        If there is neither.
    """
    if trial.tau is not None:
        return trial.tau
    if arm.control.law == "measured" or trial.ref is None:
        missing = "columns tau1…, or a control law in the arm file" if trial.ref is not None else "columns tau1…"
        raise DataError(f"trial {trial.name}: nothing says which torque drove it; expected {missing}")
    return law_torque(arm.control, trial)


def sharp_torque(arm: Arm, trial: Trial) -> Floats:
    """Return the torque that was asked for with its jumps, before the column filter, ends included.

    Parameters
    ----------
    arm : Arm
    trial : Trial

    Returns
    -------
    (n_sample + 2 * trimmed, n_joint)
        Measured, or the law's for the smooth motion and the target as it was held.
    """
    if "tau" in trial.whole:
        return trial.whole["tau"]
    u = drive_torque(arm, trial)
    if trial.ref is not None and trial.drives is not None and trial.tau is None:
        u = trial.drives.torque(arm.control, trial.q, trial.dq, trial.ddq, trial.ref)
    elif trial.ref is not None and trial.ref_filtered is not None and trial.tau is None:
        u = u + np.asarray(arm.control.kp) * (trial.ref - trial.ref_filtered)
    return np.pad(u, ((trial.trimmed, trial.trimmed), (0, 0)), mode="edge")


#: Which of a motion's samples.
Samples: TypeAlias = slice | NDArray[np.intp]


class BaseColumns:
    """The base parameters that are sought, in any gravity.

    Parameters
    ----------
    arm : Arm
        As its file has it.
    denied : tuple of str
        Beginnings of names of base parameters that are left out, such as ``D`` and ``fc``.
    known : (column, value), optional
        A standard parameter that is not sought.
    """

    def __init__(self, arm: Arm, denied: tuple[str, ...], known: tuple[int, float] | None) -> None:
        self.arm, self.denied, self.known = arm, denied, known
        self._independent: dict[tuple[float, ...], NDArray[np.intp]] = {}

    def of(self, arm: Arm) -> NDArray[np.intp]:
        """Return the columns of the standard regressor that stand for an arm's base parameters."""
        key = (*np.sign(arm.gravity_m_s2), *(np.sign(np.subtract(arm.gravity_m_s2, self.arm.gravity_m_s2))))
        if key not in self._independent:
            x, y, z = (
                float(g if g == g0 else g0 + 0.7 + 0.1 * k)
                for k, (g, g0) in enumerate(zip(arm.gravity_m_s2, self.arm.gravity_m_s2, strict=True))
            )
            base = structural_parameters(replace(arm, gravity_m_s2=(x, y, z)))
            kept = [
                column
                for column, name in zip(base.independent, base.names, strict=True)
                if not any(name.rstrip("0123456789") == start for start in self.denied)
                and not (self.known is not None and column == self.known[0])
            ]
            self._independent[key] = np.array(kept)
        return self._independent[key]


@dataclass(frozen=True)
class HypotheticalMotion:
    """A motion under hypotheses.

    Attributes
    ----------
    motion : Motion
        As it was measured.
    arm : Arm
        Its geometry and gravity.
    q, dq, ddq, u : (n_sample, n_joint)
        Of the links, and the torque at the joints but for a gain of the drive.
    factor : (n_joint,)
        By which all that a joint resists with is scaled relative to u: 1 over that gain.
    direction : (n_sample, n_joint)
        Of the links' motion, -1 to 1.
    drift : (n_joint,)
        Rate at which the joints' friction grows with the run's time [1/s].
    columns : tuple of ndarray of shape (n_sample, n_joint, n_column)
        Columns of the equation of motion in addition to the regressor, for a gain of 1.
    guessed : (n_sample,) of bool
        Where an effect can only guess how the links move: they are not measured there.
    """

    motion: Motion
    arm: Arm
    q: Floats
    dq: Floats
    ddq: Floats
    u: Floats
    direction: Floats
    factor: Floats
    drift: Floats
    guessed: NDArray[np.bool_]
    columns: tuple[Floats, ...] = field(default=())

    @property
    def arrived(self) -> Floats:
        """The torque that reaches the joints, (n_sample, n_joint)."""
        return np.asarray(self.u / self.factor, dtype=np.float64)

    def states(self, joint: int) -> Floats:
        """Return what a joint's torque may depend on, (n_sample, 7), as in `arm.effects.joint_torque`.

        The joint's own friction is not among it: no effect that is linear beside it depends on it.
        """
        states = np.zeros((len(self.q), N_STATE))
        dq = (self.motion.speed if self.dq is self.motion.dq else self.dq)[:, joint]
        states[:, 0], states[:, 1], states[:, 2] = self.motion.t, self.q[:, joint], dq
        states[:, 3], states[:, 4] = self.direction[:, joint], self.arrived[:, joint]
        return states

    def speed_noise(self, joint: int) -> Floats:
        """Return the rms noise of the velocity among `states`, (n_sample,), 0 where that is not known."""
        noise = self.motion.speed_noise[:, joint]
        return noise if self.dq is self.motion.dq else np.zeros_like(noise)

    def base(self, independent: NDArray[np.intp], samples: Samples = slice(None)) -> Floats:
        """Return the base regressor's rows, or those of some samples, (n_sample, n_joint, n_base)."""
        n = self.arm.n_joint
        Y = regressor(self.arm, self.q[samples], self.dq[samples], self.ddq[samples])
        for j in range(n):
            Y[:, j, 11 * n + j] = self.direction[samples, j]
            if self.drift[j]:
                Y[:, j, 10 * n + j :: n] *= 1.0 + self.drift[j] * np.maximum(self.motion.t[samples], 0.0)[:, None]
        rows = np.take(Y, independent, axis=2)
        rows *= self.factor[:, None]
        return rows

    def equations(self, independent: NDArray[np.intp], samples: Samples = slice(None)) -> Floats:
        """Return base and further columns side by side, all or of some samples, (n_sample, n_joint, n_factor)."""
        added = (one[samples] * self.factor[:, None] for one in self.columns)
        return np.concatenate([self.base(independent, samples), *added], axis=2)

    def target(self, known: tuple[int, float] | None, samples: Samples = slice(None)) -> Floats:
        """Return the right-hand side of the equation: the torque, less what a known parameter asks for."""
        if known is None:
            return self.u[samples]
        column, value = known
        Y = regressor(self.arm, self.q[samples], self.dq[samples], self.ddq[samples])[..., column]
        return np.asarray(self.u[samples] - value * Y * self.factor, dtype=np.float64)


def as_measured(motion: Motion, arm: Arm) -> HypotheticalMotion:
    """Return a motion as it was measured."""
    n = motion.q.shape[1]
    moves = motion.q, motion.dq, motion.ddq, motion.u, motion.direction
    return HypotheticalMotion(
        motion, arm, *moves, factor=np.ones(n), drift=np.zeros(n), guessed=np.zeros(len(motion.t), dtype=np.bool_)
    )
