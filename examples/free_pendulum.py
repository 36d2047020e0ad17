"""A double pendulum that swings freely: no torque was measured, so its parameters are identified up to one factor.

The recording is that of the MultiArm-Pendulum repository (80 s at 1 kHz, encoders; MIT). Seventy seconds are
learnt from by the error of simulated motion, ten are held back; what counts is how far a simulation of two seconds
goes astray.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy.io
from rich.table import Table
from scipy.optimize import least_squares

from arm.arm_file import load_arm, save_arm
from arm.model import Arm, Floats
from arm.regressor import standard_parameters
from arm.simulation import simulate
from arm.structural_parameters import structural_parameters
from fitter.data.motions import Measured
from fitter.data.trial import Trial, undriven
from fitter.data.trials import to_trials
from fitter.dynamics.evaluation import motion_error
from fitter.dynamics.fit import fit_dynamics
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, console, run_command
from limbcal.errors import DataError

HERE = Path(__file__).parent
RECORDING = Path("multiarm_pendulum") / "DoublePendulumDataForParameterEstimation.mat"
DATA = Path(os.environ.get("LIMBCAL_DATA", HERE.parent.parent / "shared" / "data"))
STEP_S = 1e-3
#: The number that sets the scale of all others: the published inertia of the second link.
KNOWN = {"I2": 0.003146173824}
HORIZON_S = 2.0
#: Starts are known to about so much [rad, rad, rad/s, rad/s].
_START_SCALE = (1e-3, 1e-3, 1e-2, 1e-2)


def swings(path: Path, cells: str) -> Trial:
    """Return the cells of the recording joined to the one swing that they are.

    Angles there are absolute and pi hangs down; ours are relative and 0 does.

    Raises
    ------
    DataError
        If the file is missing or has no such cells.
    """
    if not path.exists():
        raise DataError(f"{path}: there is no such file; set LIMBCAL_DATA to the folder of the recordings")
    content = scipy.io.loadmat(path)
    if cells not in content:
        raise DataError(f"{path}: there are no cells {cells!r}")
    theta = np.hstack([cell[:2] for cell in content[cells].ravel()])
    q = np.column_stack([theta[0] - np.pi, theta[1] - theta[0]])
    measured = Measured(cells, str(path), 0, STEP_S * np.arange(len(q)), {"q": q})
    return undriven(to_trials([measured])[0])


def prediction_rms_mrad(arm: Arm, trial: Trial) -> Floats:
    """Return the rms error of the absolute angles, simulated for two seconds at a time, (2,) [mrad]."""
    off = np.cumsum(motion_error(arm, trial, HORIZON_S), axis=1)
    return np.asarray(1e3 * np.sqrt(np.mean(off**2, axis=0)), dtype=np.float64)


def best_start_rms_mrad(arm: Arm, trial: Trial) -> Floats:
    """Return the same from the states that go best with the windows, (2,) [mrad]: the error of the model alone.

    Interpolated counts are off by up to a milliradian, so a measured start is a part of the error of a prediction.
    """
    stride, errors = round(HORIZON_S / trial.dt_s), []
    for start in range(0, len(trial.q) - stride, stride):
        q = trial.q[start : start + stride + 1]

        def off(state: Floats, q: Floats = q) -> Floats:
            moved = simulate(arm, q, trial.dt_s, state[:2], state[2:], torque=np.zeros_like(q))
            return np.asarray(moved.q - q, dtype=np.float64).ravel()

        found = least_squares(off, np.concatenate([q[0], trial.dq[start]]), x_scale=_START_SCALE)
        errors.append(np.cumsum(found.fun.reshape(-1, 2), axis=1))
    return np.asarray(1e3 * np.sqrt(np.mean(np.concatenate(errors) ** 2, axis=0)), dtype=np.float64)


def pendulum(options: argparse.Namespace) -> Document:
    """Learn, predict, compare with the published model."""
    learn, held_back = (swings(options.data / RECORDING, cells) for cells in ("Y_id", "Y_vad"))
    arm = load_arm(str(HERE / "free-pendulum.toml"))
    published = load_arm(str(HERE / "free-pendulum-published.toml"))
    base = structural_parameters(arm)
    viscous = {name: 0.0 for name in base.names if name.startswith("fc")}
    found = {
        name: fit_dynamics(arm, [learn], objective="motion", fixed=KNOWN | known, window_s=HORIZON_S)
        for name, known in (("viscous friction", viscous), ("and Coulomb friction", {}))
    }
    options.out.mkdir(parents=True, exist_ok=True)
    save_arm(replace(found["and Coulomb friction"].arm, name="free-pendulum"), options.out / "free-pendulum.toml")
    errors = {"published": [prediction_rms_mrad(published, trial) for trial in (learn, held_back)]}
    errors |= {
        name: [prediction_rms_mrad(fit.arm, trial) for trial in (learn, held_back)] for name, fit in found.items()
    }
    _show(errors)
    fit = found["and Coulomb friction"]
    values = dict(zip(base.names, base.combination @ standard_parameters(published), strict=True))
    table = Table("parameter", "found", "95 % interval", "published", "unit", title="Parameters, in units of I2")
    for name, p in fit.parameters.items():
        interval = "given" if name in KNOWN else "–" if p.ci95 is None else f"{p.ci95[0]:.5g} … {p.ci95[1]:.5g}"
        known = f"{values[name]:.5g}" if name in values else "–"
        table.add_row(name, f"{p.value:.5g}", interval, known, p.unit)
    console.print(table)
    return {
        "parameters": {name: p.document() for name, p in fit.parameters.items()},
        "prediction_rms_mrad": {
            name: {"learn": _pooled(both[0]), "evaluate": _pooled(both[1])} for name, both in errors.items()
        },
        "fixed_by": "I2, as published; every mass, moment, inertia and friction scales with it",
    }


def _show(errors: dict[str, list[Floats]]) -> None:
    title = "Error of a prediction of 2 s, absolute angles, mrad rms"
    table = Table("model", "learnt from", "held back", title=title)
    for name, both in errors.items():
        table.add_row(name, *(f"{_pooled(rms):.2f}" for rms in both))
    console.print(table)


def _pooled(rms: Floats) -> float:
    return float(np.sqrt(np.mean(rms**2)))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the example."""
    parser = Parser(prog="examples/free_pendulum.py", description=__doc__, parents=[common_options()])
    parser.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="folder of the recordings")
    parser.add_argument("--out", type=Path, default=Path("out"), metavar="DIR", help="for the arm found (out)")
    parser.set_defaults(action=pendulum)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
