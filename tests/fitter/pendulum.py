"""A driven pendulum with something wrong, small enough to be diagnosed in a second."""

from dataclasses import replace

import numpy as np

from arm.arm_file import load_arm
from arm.model import Arm, Control, Effect, Friction
from arm.simulation import simulate
from fitter.data.motions import Measured

_DT_S, _NOISE_RAD = 0.004, 3e-4


def pendulum() -> Arm:
    """Return the arm as its file would describe it."""
    arm = load_arm("dd-arm-vertical")
    joint = replace(arm.joints[0], friction=Friction(0.3, 0.05, 0.0))
    control = Control("pd", (20.0,), (-3.0,))
    return replace(
        arm, name="pendulum", joints=(joint,), sensors=(), tip=None, base_parameters={}, control=control
    )


def swings(effects: tuple[Effect, ...], trials: int = 6, seconds: float = 3.0, seed: int = 0) -> list[Measured]:
    """Return noisy motions of a pendulum that has some effects, with their targets."""
    rng, arm = np.random.default_rng(seed), replace(pendulum(), effects=effects)
    t = np.arange(round(seconds / _DT_S)) * _DT_S
    motions = []
    for k in range(trials):
        rate = 2.0 * np.pi * np.array([0.3, 0.6, 1.1]) * rng.uniform(0.5, 1.5, 3)
        ref = 0.6 * np.sin(np.outer(t, rate) + rng.uniform(0.0, 2.0 * np.pi, 3)).sum(axis=1, keepdims=True)
        q = simulate(arm, ref, _DT_S, ref[0], np.zeros(1), t0_s=k * seconds, trial=k + 1).q
        noisy = q + _NOISE_RAD * rng.normal(size=q.shape)
        motions.append(Measured(f"swing {k + 1}", "test", 0, t, {"q": noisy, "ref": ref}))
    return motions


def stop_that_no_learning_trial_reaches(*others: Effect, learning: int = 3) -> list[Measured]:
    """Return motions of a pendulum with a stop at 0.8 rad: a few stay away from it, as many reach it."""
    stop = Effect("end_stop", {"angle_rad": 0.8, "stiffness_N_m_rad": 6.0, "side": 1.0}, joints=(1,))
    motions = sorted(swings((*others, stop), trials=16), key=lambda one: float(one.columns["q"].max()))
    assert motions[learning - 1].columns["q"].max() < 0.75 < motions[-learning].columns["q"].max()
    return [*motions[:learning], *motions[-learning:]]


def columns(motions: list[Measured]) -> dict[str, np.ndarray]:
    """Return motions as one file holds them."""
    return {
        "t": np.concatenate([motion.t for motion in motions]),
        "trial": np.concatenate([np.full(len(motion.t), k) for k, motion in enumerate(motions, 1)]),
        **{name: np.concatenate([motion.columns[name] for motion in motions]) for name in ("q", "ref")},
    }
