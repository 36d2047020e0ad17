"""Effects that change links, gravity or what holds a joint, drawn at random but for their strength."""

import numpy as np

from benchmarks.hidden_arms.hidden_arm import ALONG, INERTIA, MASS
from benchmarks.hidden_arms.hiding import Hiding, Rng, Scene, either_way, with_cells


def stiction(rng: Rng, scene: Scene, i: int) -> Hiding:
    """Draw what a joint at rest holds, 1.5 to 4 times its Coulomb friction; its strength is not searched for."""
    F = float(rng.uniform(1.5, 4.0) * scene.arm.friction[i, 1])
    return Hiding(
        "stiction",
        (i,),
        lambda arm, s: arm._replace(friction=with_cells(arm.friction, (i,), 2, F)),
        lambda s: [{"joints": [i + 1], "parameters": {"static_N_m": F}}],
    )


def gravity_tilt(rng: Rng, scene: Scene, _i: int) -> Hiding:
    way = rng.uniform(-np.pi, np.pi)
    towards = 9.80665 * np.array([np.cos(way), np.sin(way)])
    return Hiding(
        "gravity_tilt",
        (),
        lambda arm, s: arm._replace(gravity=arm.gravity + towards * s),
        lambda s: [{"parameters": {"gx_m_s2": float(towards[0] * s), "gy_m_s2": float(towards[1] * s)}}],
        most=0.6,
        start=0.05,
    )


def rotor_inertia(rng: Rng, scene: Scene, i: int) -> Hiding:
    J = float(np.sum(scene.arm.links[i:, INERTIA] + scene.arm.links[i:, MASS] * scene.arm.links[i:, ALONG] ** 2))
    return Hiding(
        "rotor_inertia",
        (i,),
        lambda arm, s: arm._replace(rotor=with_cells(arm.rotor[:, None], (i,), 0, J * s)[:, 0]),
        lambda s: [{"joints": [i + 1], "parameters": {"inertia_kg_m2": J * s}}],
        most=4.0,
    )


def payload(rng: Rng, scene: Scene, _i: int) -> Hiding:
    """Draw a mass that is there in some trials, at least one of each set and not all; or from some time on."""
    m, bench = float(scene.arm.links[-1, MASS]), scene.bench
    if rng.random() < 0.4:
        since = (
            float(rng.uniform(1.0, bench.learning - 1.0) * bench.trial_s) if bench.learning > 1 else bench.rest_s
        )
        return Hiding(
            "payload",
            (),
            lambda arm, s: arm._replace(payload_since=np.array([m * s, since])),
            lambda s: [{"parameters": {"mass_kg": m * s, "since_s": since}}],
            most=2.0,
        )
    carried = np.zeros(bench.trials, dtype=bool)
    for first, count in ((0, bench.learning), (bench.learning, bench.evaluating)):
        chosen = rng.choice(count, int(rng.integers(1, max(count, 2))), replace=False)
        carried[first + chosen] = True
    return Hiding(
        "payload",
        (),
        lambda arm, s: arm._replace(payload_kg=m * s * np.append(carried, carried[-1]).astype(float)),
        lambda s: [{"parameters": {"mass_kg": m * s, "trials": [int(k) + 1 for k in np.flatnonzero(carried)]}}],
        most=2.0,
    )


def joint_zero(rng: Rng, scene: Scene, i: int) -> Hiding:
    way = either_way(rng)
    return Hiding(
        "joint_zero",
        (i,),
        lambda arm, s: arm._replace(offset=with_cells(arm.offset[:, None], (i,), 0, way * s)[:, 0]),
        lambda s: [{"joints": [i + 1], "parameters": {"offset_rad": way * s}}],
        most=0.6,
        start=0.05,
    )
