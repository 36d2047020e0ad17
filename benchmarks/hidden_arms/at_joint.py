"""Effects that resist or help one joint, drawn at random but for their strength."""

import numpy as np

from benchmarks.hidden_arms.hidden_arm import HiddenArm
from benchmarks.hidden_arms.hiding import Entry, Hiding, Rng, Scene, at_joint, either_way, log_uniform, with_action


def coulomb_asymmetry(rng: Rng, scene: Scene, i: int) -> Hiding:
    c = either_way(rng) * scene.torque[i]
    return at_joint("coulomb_asymmetry", i, lambda s: (c * s,), "difference_N_m")


def stribeck(rng: Rng, scene: Scene, i: int) -> Hiding:
    v = scene.speed[i] * log_uniform(rng, 0.1, 0.8)
    return at_joint("stribeck", i, lambda s: (scene.torque[i] * s, v), "amplitude_N_m velocity_rad_s", most=0.7)


def load_friction(rng: Rng, scene: Scene, i: int) -> Hiding:
    return at_joint("load_friction", i, lambda s: (s,), "coefficient", most=0.6)


def quadratic_drag(rng: Rng, scene: Scene, i: int) -> Hiding:
    scale = scene.torque[i] / scene.speed[i] ** 2
    return at_joint("quadratic_drag", i, lambda s: (scale * s,), "drag_N_m_s2", most=2.0)


def air_drag(rng: Rng, scene: Scene, i: int) -> Hiding:
    scale = scene.torque[i] / scene.speed[i] ** 2
    return at_joint("air_drag", i, lambda s: (scale * s,), "drag_N_m_s2", most=2.0)


def joint_spring(rng: Rng, scene: Scene, i: int) -> Hiding:
    k, rest = scene.torque[i] / 0.7, rng.uniform(-0.8, 0.8)
    return at_joint("joint_spring", i, lambda s: (k * s, rest), "stiffness_N_m_rad rest_angle_rad", most=3.0)


def end_stop(rng: Rng, scene: Scene, i: int) -> Hiding:
    side, share = either_way(rng), rng.uniform(0.75, 0.95)
    angle = float(np.quantile(scene.motion.q[:, i], share if side > 0 else 1.0 - share))
    k, names = scene.torque[i] / 0.3, "angle_rad stiffness_N_m_rad side"
    return at_joint("end_stop", i, lambda s: (angle, k * s, side), names, most=100.0)


def cogging(rng: Rng, scene: Scene, i: int) -> Hiding:
    turns, phase = round(log_uniform(rng, 4.0, 40.0)), rng.uniform(-np.pi, np.pi)
    names = "amplitude_N_m phase_rad periods_per_turn"
    return at_joint("cogging", i, lambda s: (scene.torque[i] * s, phase, turns), names)


def torque_offset(rng: Rng, scene: Scene, i: int) -> Hiding:
    c = either_way(rng) * scene.torque[i]
    return at_joint("torque_offset", i, lambda s: (c * s,), "torque_N_m")


def thermal_drift(rng: Rng, scene: Scene, i: int) -> Hiding:
    return at_joint("thermal_drift", i, lambda s: (s,), "rate_1_s", most=0.1, start=0.03)


def periodic_disturbance(rng: Rng, scene: Scene, i: int) -> Hiding:
    f, phase = log_uniform(rng, 0.3, 6.0), rng.uniform(-np.pi, np.pi)
    names = "amplitude_N_m frequency_hz phase_rad"
    return at_joint("periodic_disturbance", i, lambda s: (scene.torque[i] * s, f, phase), names)


def external_push(rng: Rng, scene: Scene, i: int) -> Hiding:
    """Draw one to three pushes in the learning trials; what happens later nobody could foresee."""
    n, end_s = int(rng.integers(1, 4)), scene.bench.learning * scene.bench.trial_s
    slots = (
        np.sort(rng.choice(np.arange(1, int(end_s) - 1), n, replace=False)) + rng.uniform(0.0, 0.4, n)
    ).tolist()
    lasting, strong = rng.uniform(0.1, 0.5, n).tolist(), rng.choice([-1.0, 1.0], n) * rng.uniform(0.7, 1.4, n)
    pushes = [(*push[:2], float(push[2])) for push in zip(slots, lasting, scene.torque[i] * strong, strict=True)]

    def hide(arm: HiddenArm, s: float) -> HiddenArm:
        for start, duration, c in pushes:
            arm = with_action(arm, "external_push", i, start, duration, c * s)
        return arm

    def entries(s: float) -> list[Entry]:
        return [
            {"joints": [i + 1], "parameters": {"start_s": start, "duration_s": duration, "torque_N_m": c * s}}
            for start, duration, c in pushes
        ]

    return Hiding("external_push", (i,), hide, entries, most=10.0, start=0.5, learning_only=True)
