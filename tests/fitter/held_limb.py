"""A limb under law (5) with a slow equilibrium trajectory: moved at will, or let go from a load."""

from pathlib import Path

import numpy as np

from arm.arm_file import save_arm
from arm.model import Arm, Control, Friction, Joint, Link, Vector3
from arm.simulation import simulate
from fitter.data.trial import Trial
from fitter.data.trials import load_trials

_DT_S, _NOISE_RAD = 0.01, 1e-3
_DOWN: Vector3 = (9.80665, 0.0, 0.0)
_DAMPING = 0.1
#: Stiffness [N m/rad], and kv [N m s/rad] of a limb that is moved at will and of one that swings out.
KP, KV_MOVED, KV_LOOSE = 20.0, -1.5, -0.2


def limb(kv: float) -> Arm:
    """Return a forearm that hangs down, held by law (5)."""
    link = Link(1.5, (0.15, 0.0, 0.0), (0.01, 0.05, 0.05, 0.0, 0.0, 0.0))
    joint = Joint(a_m=0.25, link=link, friction=Friction(_DAMPING, 0.0, 0.0))
    return Arm("forearm", (joint,), _DOWN, control=Control("pd", (KP,), (kv,)))


def write_motions(folder: Path, arm: Arm, *, slow_hz: float, released_rad: float, seed: int, n: int = 8) -> None:
    """Write motions of 4 s at 100 Hz with an equilibrium trajectory slower than some frequency."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 4.0, _DT_S)
    folder.mkdir(exist_ok=True)
    for k in range(n):
        rates, sizes, phases = rng.uniform(0.1, 1.0, 6), rng.uniform(0.1, 0.5, 6), rng.uniform(0.0, 6.28, 6)
        ref = np.sin(2.0 * np.pi * slow_hz * np.outer(t, rates) + phases) @ sizes
        begun = ref[:1] + released_rad * rng.choice([-1.0, 1.0])
        q = simulate(arm, ref[:, None], _DT_S, begun).q + _NOISE_RAD * rng.standard_normal((len(t), 1))
        rows = np.column_stack([t, q])
        np.savetxt(folder / f"motion{k}.csv", rows, delimiter=",", header="t,q1", comments="")


def released(folder: Path, seed: int = 0) -> list[Trial]:
    """Return trials of a limb that is let go from a load, again and again."""
    write_motions(folder, limb(KV_LOOSE), slow_hz=0.3, released_rad=0.4, seed=seed)
    return load_trials([folder], 1, None, arm=limb(KV_LOOSE))


def moved(folder: Path, seed: int = 0) -> list[Trial]:
    """Return trials of a limb that is moved at will."""
    write_motions(folder, limb(KV_MOVED), slow_hz=1.0, released_rad=0.0, seed=seed)
    return load_trials([folder], 1, None, arm=limb(KV_MOVED))


def unknown_limb(path: Path) -> Path:
    """Write the limb's file as of a person: nothing says which law holds it. Return the path."""
    arm = limb(KV_LOOSE)
    save_arm(Arm(arm.name, arm.joints, arm.gravity_m_s2), path)
    return path
