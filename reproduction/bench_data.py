"""Motions of the bench for the paper's experiments: other laws, gains and sample counts, noise in the angles.

What the paper calls "an error of the angles of 5 %" it does not say. Here it is white Gaussian noise, independent
in every sample and joint, with a standard deviation of that share of the angle's own: its rms about its mean over
the motions that are learnt from.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.bench import Bench, densify, motions, targets
from arm.kinematics import tip_position
from arm.model import Arm, Control, Floats, Joint, Law
from arm.regressor import standard_parameters
from arm.simulation import Motion, simulate
from fitter.data.motions import Measured
from fitter.data.trial import Trial
from fitter.data.trials import to_trials
from fitter.report.published import ARM, SAMPLES

#: How velocities and accelerations come about where the angles have noise: as they truly were; by the paper's
#: moving average of four and differences; or by differentiating behind a zero-phase filter with its corner found
#: in the data, as every measured motion is treated here.
Derivatives = Literal["exact", "differences", "filtered"]

#: The moving average of section 2.2.
_AVERAGED = 4
#: A trial has at least this many samples: fewer can't be filtered.
_FEWEST = 64


def true_arm() -> Arm:
    """Return the paper's arm with the dynamics of Table 3's first row and its control law (5) at 9.5 / -9.5."""
    return load_arm(ARM)


def unknown_arm(arm: Arm, length_m: float = 0.5) -> Arm:
    """Return an arm as it can be described before any calibration.

    Its joints and their kinds, its sensors' places on their links and its law are known; lengths are a guess, and
    its dynamics say nothing.
    """
    blank = [Joint(type=joint.type, a_m=length_m if joint.a_m else 0.0) for joint in arm.joints]
    return replace(arm, name=f"{arm.name}, uncalibrated", joints=tuple(blank), base_parameters={})


def under(arm: Arm, law: Law, kp: float, kv: float | None = None, ka: float | None = None) -> Arm:
    """Return the arm under a law with the same gains in every joint; None for one that is not part of the law."""
    kps, kvs, kas = (() if gain is None else (gain,) * arm.n_joint for gain in (kp, kv, ka))
    return replace(arm, control=Control(law, kps, kvs, kas))


def true_values(arm: Arm) -> dict[str, float]:
    """Return the base parameters of an arm by name."""
    base = base_parameters(arm)
    return dict(zip(base.names, (base.combination @ standard_parameters(arm)).tolist(), strict=True))


def bench_trials(
    arm: Arm,
    samples: int = SAMPLES,
    seed: int = 0,
    learning: int = Bench.learning,
    evaluating: int = 0,
    held: bool = False,
) -> list[Trial]:
    """Return the bench's motions as they truly are, sampled evenly.

    Parameters
    ----------
    arm : Arm
        Its control law drives it, from one target drawn by the seed to the next.
    samples : int
        Of all learning trials together, as near as an equal number each comes to it; evaluating trials have the
        same rate.
    seed : int
    learning, evaluating : int
        How many motions.
    held : bool
        The arm is held still until each motion begins, see `held_motions`.

    Returns
    -------
    list of Trial
        With exact derivatives, torque, target, tip and role.

    Raises
    ------
    ConfigError
        If the arm has no control law to drive it.
    """
    bench = Bench(learning=learning, evaluating=evaluating)
    each = max(_FEWEST, round(samples / max(learning, 1)))
    bench = replace(bench, rate_hz=each / bench.trial_s)
    moved = held_motions(arm, bench, seed) if held else motions(arm, bench, seed)
    return [
        Trial(
            name=f"bench/{number}",
            t=motion.t,
            dt_s=1.0 / bench.rate_hz,
            q=motion.q,
            dq=motion.dq,
            ddq=motion.ddq,
            tau=motion.tau,
            ref=motion.ref,
            tip=tip_position(arm, motion.q),
            role="learn" if number <= learning else "evaluate",
        )
        for number, motion in enumerate(moved, 1)
    ]


def held_motions(arm: Arm, bench: Bench, seed: int) -> Iterator[Motion]:
    """Yield the bench's trials with the arm held still at the target before until each begins.

    Under a law without damping, eq. (7), the arm never comes to rest by itself, and the bench's trials would begin
    with whatever swing the one before leaves.
    """
    goals = targets(bench, arm.n_joint, seed)
    step = 1.0 / bench.simulation_hz
    n, rest = round(bench.trial_s / step), round(bench.rest_s / step)
    for before, goal in pairwise(goals):
        ref = np.vstack([np.tile(before, (rest, 1)), np.tile(goal, (n - rest + 1, 1))])
        yield densify(simulate(arm, ref, step, before), bench.rate_hz, round(bench.trial_s * bench.rate_hz))


def angle_spread(trials: Sequence[Trial]) -> Floats:
    """Return the rms of every angle about its mean over some trials, (n_joint,): what noise is a share of."""
    return np.asarray(np.concatenate([trial.q for trial in trials]).std(axis=0), dtype=np.float64)


def noisy_trials(
    trials: Sequence[Trial], share: float, seed: int, derivatives: Derivatives = "filtered"
) -> list[Trial]:
    """Return trials as somebody sees them who measures the angles with noise.

    Parameters
    ----------
    trials : sequence of Trial
    share : float
        Standard deviation of the noise as a share of `angle_spread`.
    seed : int
    derivatives : {"exact", "differences", "filtered"}

    Returns
    -------
    list of Trial
        Without torque and tip, with the target. Where the angles were filtered, ``whole`` holds them with nothing
        but their noise.
    """
    std, rng = share * angle_spread(trials), np.random.default_rng([seed, 3, round(1e6 * share)])
    measured = [trial.q + std * rng.standard_normal(trial.q.shape) for trial in trials]
    if derivatives == "filtered":
        motions_seen = [
            Measured(trial.name, trial.name, 0, trial.t, {"q": q, "ref": np.asarray(trial.ref)})
            for trial, q in zip(trials, measured, strict=True)
        ]
        pairs = zip(to_trials(motions_seen), trials, strict=True)
        return [replace(seen, role=trial.role) for seen, trial in pairs]
    if derivatives == "differences":
        return [_differenced(trial, q) for trial, q in zip(trials, measured, strict=True)]
    return [replace(trial, q=q, tau=None, tip=None) for trial, q in zip(trials, measured, strict=True)]


def _differenced(trial: Trial, q: Floats) -> Trial:
    """Return a trial with the paper's moving average, central differences, and no other filter."""
    n = len(q) - _AVERAGED + 1
    total = np.vstack([np.zeros(q.shape[1]), np.cumsum(q, axis=0)])
    mean = (total[_AVERAGED:] - total[:-_AVERAGED]) / _AVERAGED
    dq = np.gradient(mean, trial.dt_s, axis=0)
    ddq = np.gradient(dq, trial.dt_s, axis=0)
    late = _AVERAGED // 2  # the mean of four lies between the second and the third of them
    return replace(
        trial,
        t=trial.t[:n],
        q=mean,
        dq=dq,
        ddq=ddq,
        tau=None,
        ref=None if trial.ref is None else trial.ref[late : late + n],
        tip=None,
        whole={"q": q[late : late + n], "ref": np.asarray(trial.ref)[late : late + n]},
    )
