"""Cases for `fitter diagnose`, drawn by a seed: an arm, its motion, what is hidden in it, and the noise.

What the diagnosis is given are two sets of trials and an arm file with the true geometry and gravity; its links
are rods that nobody measured, without friction. The truth is kept apart.
"""

import json
import zlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arm.arm_file import save_arm
from arm.model import Arm, Control, Joint, Link
from benchmarks.hidden_arms.arms import draw_scene, sound
from benchmarks.hidden_arms.effects import EFFECTS, OUTSIDE, joints_for
from benchmarks.hidden_arms.hidden_arm import LENGTH, Floats, HiddenArm, Recorded
from benchmarks.hidden_arms.hiding import Bench, Hiding, Rng, Scene
from benchmarks.hidden_arms.simulation import simulate
from benchmarks.hidden_arms.size import LEAST_SHARE, MOST_SHARE, find_strength, unexplained

KINDS = ("one", "nothing", "two", "outside")


ANGLE_NOISE_RAD = 2e-4


TORQUE_NOISE = 0.01


@dataclass(frozen=True)
class Case:
    """One case: what the diagnosis is given, and the truth.

    Attributes
    ----------
    arm : Arm
        What is known beforehand.
    t, trial : (n_sample,)
    q, tau, ref : (n_sample, n)
        As measured.
    truth : dict
    hidden : HiddenArm
        What was simulated, and ``recorded`` how it moved.
    """

    arm: Arm
    t: Floats
    trial: NDArray[np.int64]
    q: Floats
    tau: Floats
    ref: Floats
    truth: dict[str, Any] = field(repr=False)
    hidden: HiddenArm = field(repr=False)
    recorded: Recorded = field(repr=False)
    bench: Bench = field(repr=False)

    def columns(self, learning: bool) -> dict[str, NDArray[Any]]:
        """Return the columns of the learning or of the evaluating trials."""
        rows = (self.trial <= self.bench.learning) == learning
        flat: dict[str, NDArray[Any]] = {"t": self.t[rows], "trial": self.trial[rows]}
        for name in ("q", "tau", "ref"):
            for i, column in enumerate(getattr(self, name).T):
                flat[f"{name}{i + 1}"] = column[rows]
        return flat

    def write(self, folder: Path) -> tuple[Path, Path, Path]:
        """Write ``learn.npz``, ``evaluate.npz`` and ``arm.toml``, but not the truth; return their paths."""
        folder.mkdir(parents=True, exist_ok=True)
        learn, evaluate, arm = folder / "learn.npz", folder / "evaluate.npz", folder / "arm.toml"
        np.savez(learn, **self.columns(True))
        np.savez(evaluate, **self.columns(False))
        save_arm(self.arm, arm)
        return learn, evaluate, arm

    def write_truth(self, path: Path) -> None:
        """Write the truth as JSON."""
        path.write_text(json.dumps(self.truth, indent=2) + "\n", encoding="utf-8")


def draw_case(seed: int, kind: str, effect: str | None = None, bench: Bench | None = None) -> Case:
    """Draw a case; the same seed, kind and effect give the same case.

    Parameters
    ----------
    seed : int
    kind : {"one", "nothing", "two", "outside"}
    effect : str, optional
        Which effect is hidden, or the first of two; drawn unless given.
    bench : Bench, optional

    Raises
    ------
    RuntimeError
        If nothing visible could be hidden after many tries, as in a bench too short for it.
    """
    bench = bench or Bench()
    rng = np.random.default_rng([seed, zlib.crc32(f"{kind} {effect}".encode())])
    for _ in range(60):
        names = _names(rng, kind, effect)
        scene = draw_scene(rng, bench, names)
        if scene is None:
            continue
        hidden = _hide(rng, scene, names)
        if hidden is None:
            continue
        arm, recorded, truths = hidden
        truth = {"seed": seed, "kind": kind, "effects": truths, "arm": _arm_truth(scene.arm)}
        return _measure(rng, scene, arm, recorded, truth)
    raise RuntimeError(f"seed {seed}: no arm found in which {effect or kind} is visible")


def _names(rng: Rng, kind: str, effect: str | None) -> list[str]:
    if kind == "nothing":
        return []
    if kind == "outside":
        return [effect or str(rng.choice(list(OUTSIDE)))]
    first = effect or str(rng.choice(list(EFFECTS)))
    if kind == "one":
        return [first]
    others = [name for name in EFFECTS if name not in (first, "stiction")]
    return [first, str(rng.choice(others))]


def _hide(rng: Rng, scene: Scene, names: list[str]) -> tuple[HiddenArm, Recorded, list[dict[str, Any]]] | None:
    """Hide the effects, each of a visible size by itself; return the arm, its motion and the truth."""
    arm, found = scene.arm, []
    for name in names:
        draw = EFFECTS.get(name) or OUTSIDE[name]
        hiding = draw(rng, scene, int(rng.choice(joints_for(name, scene))))
        sized = find_strength(rng, scene, hiding)
        if sized is None:
            return None
        arm = hiding.hide(arm, sized[0])
        found.append((hiding, *sized))
    bench = scene.bench
    recorded = simulate(arm, scene.ref, bench.rate_hz, bench.trial_s, bench.step_hz)
    if not sound(recorded):
        return None
    if len(found) == 1 and found[0][0].name != "stiction":
        hiding, strength, _ = found[0]
        share = unexplained(scene, hiding, arm, recorded)
        if not LEAST_SHARE <= share <= MOST_SHARE:
            return None
        found = [(hiding, strength, share)]
    return arm, recorded, [_truth(*one) for one in found]


def _truth(hiding: Hiding, strength: float, share: float) -> dict[str, Any]:
    return {
        "effect": hiding.name,
        "joints": [i + 1 for i in hiding.joints],
        "entries": hiding.entries(strength),
        "unexplained": share,
        "variables": list(hiding.variables),
    }


def _measure(rng: Rng, scene: Scene, arm: HiddenArm, recorded: Recorded, truth: dict[str, Any]) -> Case:
    noise = TORQUE_NOISE * np.sqrt(np.mean(recorded.u**2, axis=0))
    size = round(scene.bench.trial_s * scene.bench.rate_hz)
    law = str(rng.choice(["measured", "pd"]))
    return Case(
        arm=_known_beforehand(scene.arm, law),
        t=recorded.t,
        trial=np.repeat(np.arange(1, scene.bench.trials + 1), size),
        q=recorded.q + ANGLE_NOISE_RAD * rng.standard_normal(recorded.q.shape),
        tau=recorded.u + noise * rng.standard_normal(recorded.u.shape),
        ref=recorded.ref,
        truth=truth | {"law": law, "torque_noise_N_m": noise.tolist()},
        hidden=arm,
        recorded=recorded,
        bench=scene.bench,
    )


def _known_beforehand(arm: HiddenArm, law: str) -> Arm:
    """Return what an engineer would write down: lengths, gravity, perhaps the law; one-kilogram rods for links."""
    joints = []
    for length in arm.links[:, LENGTH].tolist():
        turning = length**2 / 3.0
        rod = Link(1.0, (length / 2.0, 0.0, 0.0), (1e-3, turning, turning, 0.0, 0.0, 0.0))
        joints.append(Joint(a_m=length, link=rod))
    gx, gy = arm.gravity.tolist()
    control = Control()
    if law == "pd":
        control = Control("pd", tuple(arm.gains[:, 0].tolist()), tuple(arm.gains[:, 1].tolist()))
    gravity = (gx, gy, 0.0 if gx or gy else -9.80665)
    return replace(Arm("hidden", tuple(joints), gravity), control=control)


def _arm_truth(arm: HiddenArm) -> dict[str, Any]:
    parts = ("links", "gravity", "friction", "gains")
    return {name: getattr(arm, name).tolist() for name in parts}
