"""Effects between the controller and the link, drawn at random but for their strength."""

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.hidden_arms.hidden_arm import DAMPING, DELAY_S, FACTOR, GAP, LAG_S, LIMIT, STIFFNESS, HiddenArm
from benchmarks.hidden_arms.hiding import Hiding, Rng, Scene, either_way, log_uniform, with_cells


def _in_drive(
    name: str, joints: tuple[int, ...], column: int, parameter: str, number: Callable[[float], float], **rest: Any
) -> Hiding:
    return Hiding(
        name,
        joints,
        lambda arm, s: arm._replace(drive=with_cells(arm.drive, joints, column, number(s))),
        lambda s: [{"joints": [i + 1 for i in joints], "parameters": {parameter: number(s)}}],
        **rest,
    )


def _one_or_all(rng: Rng, scene: Scene, i: int) -> tuple[int, ...]:
    return tuple(range(scene.n)) if rng.random() < 0.4 else (i,)


def actuator_delay(rng: Rng, scene: Scene, i: int) -> Hiding:
    def whole(s: float) -> float:
        return max(round(s * scene.bench.step_hz), 1) / scene.bench.step_hz

    return _in_drive("actuator_delay", _one_or_all(rng, scene, i), DELAY_S, "delay_s", whole, most=0.1, start=0.01)


def actuator_lag(rng: Rng, scene: Scene, i: int) -> Hiding:
    joints = _one_or_all(rng, scene, i)
    return _in_drive("actuator_lag", joints, LAG_S, "time_constant_s", lambda s: s, most=0.2, start=0.01)


def torque_saturation(rng: Rng, scene: Scene, i: int) -> Hiding:
    highest = float(np.abs(scene.motion.u[:, i]).max())
    return _in_drive(
        "torque_saturation", (i,), LIMIT, "limit_N_m", lambda s: highest * float(np.exp(-s)), most=2.5, start=0.4
    )


def gain_error(rng: Rng, scene: Scene, i: int) -> Hiding:
    way = either_way(rng)
    return _in_drive("gain_error", (i,), FACTOR, "factor", lambda s: float(np.exp(way * s)), most=0.9)


def backlash(rng: Rng, scene: Scene, i: int) -> Hiding:
    return Hiding(
        "backlash",
        (i,),
        lambda arm, s: arm._replace(transmission=with_cells(arm.transmission, (i,), GAP, 0.2 * s)),
        lambda s: [{"joints": [i + 1], "parameters": {"gap_rad": 0.2 * s}}],
    )


def joint_elasticity(rng: Rng, scene: Scene, i: int) -> Hiding:
    k, lasting_s = scene.torque[i] / 0.3, log_uniform(rng, 0.002, 0.015)

    def numbers(s: float) -> tuple[float, float]:
        return float(k / s), float(k / s * lasting_s)

    def hide(arm: HiddenArm, s: float) -> HiddenArm:
        stiff = with_cells(arm.transmission, (i,), STIFFNESS, numbers(s)[0])
        return arm._replace(transmission=with_cells(stiff, (i,), DAMPING, numbers(s)[1]))

    return Hiding(
        "joint_elasticity",
        (i,),
        hide,
        lambda s: [
            {
                "joints": [i + 1],
                "parameters": dict(zip(("stiffness_N_m_rad", "damping_N_m_s"), numbers(s), strict=True)),
            }
        ],
    )
