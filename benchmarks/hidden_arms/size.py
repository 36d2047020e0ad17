"""How strong an effect must be to leave a given share of the torque unexplained by the best base model."""

import numpy as np

from benchmarks.hidden_arms.arms import SOME_TRIALS, quick, sound
from benchmarks.hidden_arms.effects import WHOLE
from benchmarks.hidden_arms.hidden_arm import GAP, LENGTH, STIFFNESS, HiddenArm, Recorded
from benchmarks.hidden_arms.hiding import Hiding, Rng, Scene
from benchmarks.hidden_arms.unexplained import columns, fit, lowpass, rms

#: What the best base model leaves unexplained of the torque of the joint concerned.
LEAST_SHARE, MOST_SHARE = 0.04, 0.15


#: Where the motor leads the link its angle jumps: the share is that in the band of the motion.
TRANSMITTED_HZ = 6.0


#: What a hidden static friction must at least change in the torque of its joint.
STUCK_SHARE = 0.02


#: The search for a size ends within this of the share that was drawn.
NEAR = 0.1


def unexplained(scene: Scene, hiding: Hiding, arm: HiddenArm, motion: Recorded) -> float:
    """Return how much of the noise-free torque the best base model leaves unexplained.

    It is the share of the joint that the effect is at; of effects of the whole arm it is that of the joint where
    they show most.
    """
    q, dq, ddq, tau = motion.link_q, motion.link_dq, motion.link_ddq, motion.u
    known, used = (scene.arm.links[:, LENGTH], scene.arm.gravity), motion.link_dq != 0.0
    rows = slice(None, None, 3)
    if hiding.learning_only:
        rows = slice(0, round(scene.bench.learning * scene.bench.trial_s * scene.bench.rate_hz))
    if not used[rows].any(axis=0).all():
        return np.inf  # friction holds a joint all the time
    Y = columns(*known, q, dq, ddq)
    scale = rms(tau[rows], used[rows]) if hiding.learning_only else rms(tau, used)
    if arm.transmission[:, [GAP, STIFFNESS]].any():
        # The torque is that of the link's motion; what is measured is the motor's. Both are smoothed alike.
        rate = scene.bench.rate_hz
        link, motor = (
            columns(*known, lowpass(angle, rate, TRANSMITTED_HZ), speed, np.gradient(speed, 1.0 / rate, axis=0))
            for angle, speed in (
                (q, lowpass(dq, rate, TRANSMITTED_HZ)),
                (motion.q, lowpass(motion.dq, rate, TRANSMITTED_HZ)),
            )
        )
        tau, Y = link @ fit(Y, tau, used), motor
    Y, tau, used = Y[rows], tau[rows], used[rows]
    share = rms(tau - Y @ fit(Y, tau, used), used) / scale
    joints = hiding.joints if hiding.name not in WHOLE else range(scene.n)
    return float(share[list(joints)].max())


def find_strength(rng: Rng, scene: Scene, hiding: Hiding) -> tuple[float, float] | None:
    """Return the strength that leaves the share drawn for it unexplained, and that share; nothing if none does."""
    wanted = float(rng.uniform(1.1 * LEAST_SHARE, 0.95 * MOST_SHARE))
    if hiding.name == "stiction":
        held = quick(hiding.hide(scene.arm, 1.0), scene.ref, scene.bench)
        i = hiding.joints[0]
        change = np.sqrt(np.mean((held.u - scene.motion.u)[:, i] ** 2)) / scene.torque[i]
        return (1.0, float(change)) if sound(held) and change > STUCK_SHARE else None
    low, high, s = 0.0, np.inf, hiding.start
    trials = {"payload": scene.bench.trials, "thermal_drift": scene.bench.trials}.get(hiding.name, SOME_TRIALS)
    for _ in range(9):
        motion = quick(hiding.hide(scene.arm, s), scene.ref, scene.bench, trials)
        share = unexplained(scene, hiding, hiding.hide(scene.arm, s), motion) if sound(motion) else np.inf
        if abs(share - wanted) < NEAR * wanted:
            return s, share
        low, high = (s, high) if share < wanted else (low, s)
        if low >= hiding.most:
            return None
        s = min(s * wanted / max(share, 1e-9), 6.0 * s, hiding.most)
        if not low < s < high:
            s = float(np.sqrt(max(low, 0.05 * high) * high)) if np.isfinite(high) else hiding.most
    return None
