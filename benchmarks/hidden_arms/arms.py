"""Arms drawn at random, under a control that suits them, and how they move."""

import numpy as np

from arm.arm_file import load_arm
from benchmarks.hidden_arms.effects import NEEDS_TWO, joints_for
from benchmarks.hidden_arms.forces import mass_and_bias
from benchmarks.hidden_arms.hidden_arm import (
    ACROSS,
    ALONG,
    FACTOR,
    INERTIA,
    LENGTH,
    MASS,
    Floats,
    HiddenArm,
    Recorded,
)
from benchmarks.hidden_arms.hiding import Bench, Rng, Scene
from benchmarks.hidden_arms.simulation import simulate

#: Sizes are drawn and looked for on this number of trials.
SOME_TRIALS = 8


def draw_scene(rng: Rng, bench: Bench, names: list[str]) -> Scene | None:
    """Draw an arm and its motion, or nothing if it doesn't come to rest or an effect couldn't be seen in it."""
    direct = rng.random() < 0.2
    vertical = rng.random() < (0.95 if "joint_zero" in names else 0.5)
    arm = dd_arm(vertical and "joint_zero" in names) if direct else draw_arm(rng, vertical, names)
    n = len(arm.links)
    arm = arm._replace(payload_kg=np.zeros(bench.trials + 1))
    goals = np.vstack([np.zeros(n), rng.uniform(-bench.span_rad, bench.span_rad, (bench.trials, n))])
    size, rest = round(bench.trial_s * bench.rate_hz), round(bench.rest_s * bench.rate_hz)
    ref = np.concatenate(
        [
            np.repeat([before, goal], [rest, size - rest], axis=0)
            for before, goal in zip(goals[:-1], goals[1:], strict=True)
        ]
    )
    motion = quick(arm, ref, bench)
    if not sound(motion):
        return None
    scene = Scene(arm, motion, ref, bench)
    if not direct:
        share = rng.uniform(0.0, 0.06, (2, n))
        if {"stiction", "thermal_drift"} & set(names):
            share[1] = rng.uniform(0.03, 0.06, n)
        friction = np.stack([share[0] * scene.torque / scene.speed, share[1] * scene.torque, np.zeros(n)], axis=1)
        arm = arm._replace(friction=friction)
        motion = quick(arm, ref, bench)
        scene = Scene(arm, motion, ref, bench)
    possible = sound(motion) and all(joints_for(name, scene) for name in names)
    return scene if possible else None


def dd_arm(vertical: bool) -> HiddenArm:
    """Return the paper's arm from its preset's numbers."""
    preset = load_arm("dd-arm-vertical" if vertical else "dd-arm")
    links = np.zeros((2, 5))
    for i, joint in enumerate(preset.joints):
        m, (x, y, _) = joint.link.mass_kg, joint.link.com_m
        links[i] = joint.a_m, m, x, y, joint.link.inertia_kg_m2[2] - m * (x * x + y * y)
    friction = [[j.friction.viscous_N_m_s, j.friction.coulomb_N_m, j.friction.static_N_m] for j in preset.joints]
    gains = np.stack([preset.control.kp, preset.control.kv], axis=1)
    return plain_arm(links, np.array(preset.gravity_m_s2[:2]), gains, np.array(friction))


def draw_arm(rng: Rng, vertical: bool, names: list[str]) -> HiddenArm:
    """Draw an arm that settles in 0.5 to 1.5 s, now and then as slowly as the paper's; no friction yet.

    It is well damped, unless it should swing so far that it turns round near its target; its links are heavy and
    fast where it must be seen how they throw each other about; and it has joints enough for what will be hidden.
    """
    lively, swinging = "joint_zero" in names, "stiction" in names
    of_two = [2, 3, 3] if lively else [2, 2, 2, 2, 2, 3]
    n = int(rng.choice(of_two if set(names) & NEEDS_TWO else [1, *of_two]))
    links = np.zeros((n, 5))
    links[:, LENGTH] = rng.uniform(0.2, 0.4, n)
    links[:, MASS] = np.exp(rng.uniform(np.log(1.5), np.log(8.0)))
    links[:, MASS] *= np.cumprod(rng.uniform(0.8, 1.2, n) if lively else rng.uniform(0.35, 0.8, n))
    links[:, ALONG] = (rng.uniform(0.5, 0.8, n) if lively else rng.uniform(0.3, 0.7, n)) * links[:, LENGTH]
    links[:, ACROSS] = rng.uniform(-0.15, 0.15, n) * links[:, LENGTH]
    links[:, INERTIA] = rng.uniform(0.05, 0.12, n) * links[:, MASS] * links[:, LENGTH] ** 2
    down = np.array([0.0, -9.80665]) if rng.random() < 0.5 else np.array([9.80665, 0.0])
    gravity = down if vertical else np.zeros(2)
    slow = rng.random() < 0.15 and not vertical
    settling_s = 3.0 if slow else rng.uniform(0.5, 0.55 if lively else 0.9 if vertical else 1.5)
    damping = rng.uniform(0.4, 0.7, n) if swinging else rng.uniform(0.9, 1.3, n)
    frequency = 5.0 / settling_s * rng.uniform(0.85, 1.15, n)
    arm = plain_arm(links, gravity, np.ones((n, 2)), np.zeros((n, 3)))
    weight = np.mean([np.diag(_mass(arm, rng.uniform(-1.2, 1.2, n))) for _ in range(40)], axis=0)
    gains = np.stack([weight * frequency**2, -2.0 * damping * frequency * weight], axis=1)
    return arm._replace(gains=gains)


def plain_arm(links: Floats, gravity: Floats, gains: Floats, friction: Floats) -> HiddenArm:
    """Return an arm with nothing hidden in it."""
    n = len(links)
    drive = np.zeros((n, 4))
    drive[:, FACTOR] = 1.0
    return HiddenArm(
        links=np.array(links, dtype=np.float64),
        gravity=np.array(gravity, dtype=np.float64),
        offset=np.zeros(n),
        rotor=np.zeros(n),
        friction=np.array(friction, dtype=np.float64),
        gains=np.array(gains, dtype=np.float64),
        drive=drive,
        transmission=np.zeros((n, 3)),
        payload_kg=np.zeros(1000),
        payload_since=np.array([0.0, np.inf]),
        acting=np.zeros((0, 6)),
    )


def _mass(arm: HiddenArm, q: Floats) -> Floats:
    n = len(q)
    M, bias = np.empty((n, n)), np.empty(n)
    mass_and_bias(
        arm.links, arm.gravity, arm.offset, arm.rotor, 0.0, q, np.zeros(n), M, bias, np.empty((n + 1, 2))
    )
    return M


def quick(arm: HiddenArm, ref: Floats, bench: Bench, trials: int = SOME_TRIALS) -> Recorded:
    """Simulate the first trials coarsely, to look for a size."""
    some = ref[: trials * round(bench.trial_s * bench.rate_hz)]
    return simulate(arm, some, bench.rate_hz, bench.trial_s, step_hz=min(2000.0, bench.step_hz), lead_s=4.0)


def sound(motion: Recorded) -> bool:
    return bool(np.isfinite(motion.q).all() and np.abs(motion.q).max() < 6.0)
