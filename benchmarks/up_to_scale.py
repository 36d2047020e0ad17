"""Ratios under law (5) with a free equilibrium trajectory: how often they are identified, whether intervals hold.

    python -m benchmarks.up_to_scale [--cases N]

Simulated limbs that hang down under law (5), 1 mrad of noise at 100 Hz: let go from a load again and again, or
moved at will, with equilibrium trajectories of several bandwidths. The table stands in docs/person-masses.md.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from arm.base_parameters import BaseParameters
from arm.model import Arm, Control, Floats, Friction, Joint, Link
from arm.regressor import regressor, standard_parameters
from arm.simulation import simulate
from arm.structural_parameters import structural_parameters
from fitter.controller.equilibrium_ratios import equilibrium_columns, equilibrium_ratios
from fitter.data.trial import Trial
from fitter.data.trials import load_trials

_DT_S, _NOISE_RAD, _DAMPING = 0.01, 1e-3, 0.1
_DOWN = (9.80665, 0.0, 0.0)
_RELEASED_RAD = 0.4
_STEP_RAD = 1e-5
_UPPER = Joint(
    a_m=0.3,
    link=Link(2.0, (0.14, 0.0, 0.0), (0.01, 0.06, 0.06, 0.0, 0.0, 0.0)),
    friction=Friction(_DAMPING, 0.0, 0.0),
)
_FORE = Joint(
    a_m=0.25,
    link=Link(1.5, (0.15, 0.0, 0.0), (0.01, 0.05, 0.05, 0.0, 0.0, 0.0)),
    friction=Friction(_DAMPING, 0.0, 0.0),
)


@dataclass(frozen=True)
class Case:
    """A limb and how it moves: gains of law (5), the trajectory's bandwidth, trials and their length."""

    name: str
    joints: tuple[Joint, ...]
    kp: tuple[float, ...]
    kv: tuple[float, ...]
    slow_hz: float
    trials: int
    seconds: float
    released_rad: float

    @property
    def arm(self) -> Arm:
        """The limb."""
        return Arm("limb", self.joints, _DOWN, control=Control("pd", self.kp, self.kv))


_BOTH, _STIFF = (_UPPER, _FORE), (40.0, 20.0)
CASES = (
    Case("forearm, let go, 0.3 Hz", (_FORE,), (20.0,), (-0.2,), 0.3, 10, 4.0, _RELEASED_RAD),
    Case("forearm, let go, 0.6 Hz", (_FORE,), (20.0,), (-0.2,), 0.6, 10, 4.0, _RELEASED_RAD),
    Case("both, let go, 0.3 Hz", _BOTH, _STIFF, (-0.4, -0.2), 0.3, 10, 4.0, _RELEASED_RAD),
    Case("forearm, at will, 1 Hz", (_FORE,), (20.0,), (-1.5,), 1.0, 4, 10.0, 0.0),
    Case("both, at will, 1 Hz", _BOTH, _STIFF, (-3.0, -1.5), 1.0, 4, 10.0, 0.0),
)


def moved(case: Case, seed: int, folder: Path) -> list[Trial]:
    """Simulate a case's trials, write them to files and read these."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, case.seconds, _DT_S)
    n = len(case.joints)
    header = ",".join(["t", *(f"q{j + 1}" for j in range(n))])
    for k in range(case.trials):
        omega = 2.0 * np.pi * case.slow_hz * rng.uniform(0.1, 1.0, 6)
        sines = [[rng.uniform(0.1, 0.5) * np.sin(o * t + rng.uniform(0.0, 6.28)) for o in omega] for _ in range(n)]
        ref = np.sum(sines, axis=1).T
        begun = ref[0] + case.released_rad * rng.choice([-1.0, 1.0], n)
        q = simulate(case.arm, ref, _DT_S, begun).q + _NOISE_RAD * rng.standard_normal(ref.shape)
        np.savetxt(folder / f"{k}.csv", np.column_stack([t, q]), delimiter=",", header=header, comments="")
    return load_trials([folder], n, None, arm=case.arm)


def truth(case: Case, trials: Sequence[Trial]) -> dict[str, float]:
    """Return what a case's ratios are, by their names in the answer."""
    arm, n = case.arm, len(case.joints)
    base = structural_parameters(arm)
    columns = equilibrium_columns(arm, base)
    values = np.append(base.combination @ standard_parameters(arm), case.kp)[list(columns.kept)]
    for j in range(n):
        values[columns.names.index(f"D{j + 1}-kv{j + 1}")] -= case.kv[j]
    stiff = np.array(case.kp) + _gravity(arm, base, trials)
    named = dict(zip(columns.names, values.tolist(), strict=True))
    named |= {f"kp{j + 1} and gravity": float(stiff[j]) for j in range(n)}
    reference = columns.names[columns.reference]
    return {f"({name})/{reference}": value / named[reference] for name, value in named.items()}


def _gravity(arm: Arm, base: BaseParameters, trials: Sequence[Trial]) -> Floats:
    """Return how gravity's torque in each joint turns with its angle, at the mean posture, (n_joint,)."""
    q, n = np.mean([trial.q.mean(axis=0) for trial in trials], axis=0), arm.n_joint
    step, still, own = _STEP_RAD * np.eye(n), np.zeros((n, n)), np.arange(n)
    rigid = replace(arm, control=Control())
    ahead, behind = (regressor(rigid, q + s, still, still) @ standard_parameters(rigid) for s in (step, -step))
    return np.asarray((ahead - behind)[own, own] / (2.0 * _STEP_RAD))


def main(argv: Sequence[str] | None = None) -> int:
    """Print a line a case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=24, metavar="N", help="simulated limbs of each kind (24)")
    arguments = parser.parse_args(argv)
    for case in CASES:
        identified, held, cases = 0, 0, 0
        for seed in range(arguments.cases):
            with tempfile.TemporaryDirectory() as folder:
                trials = moved(case, seed, Path(folder))
            known, true = equilibrium_ratios(case.arm, trials).known, truth(case, trials)
            identified, cases = identified + len(known), cases + bool(known)
            for one in known:
                assert one.ci95 is not None
                held += one.ci95[0] <= true[one.name] <= one.ci95[1]
        sys.stdout.write(
            f"{case.name}: identified in {cases} of {arguments.cases}, {identified} ratios, "
            f"{held} of their intervals hold\n"
        )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
