"""A double pendulum that swings freely, diagnosed: what its published, viscous model lacks.

``python -m examples.cases.multiarm_pendulum`` writes ``docs/cases/multiarm-pendulum.md`` and its picture. The
recording is that of the MultiArm-Pendulum repository (MIT): 70 s to learn from, 10 s held back.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy.io

from arm.arm_file import load_arm
from arm.model import Arm, Floats
from examples.cases.case_page import DATA, DOCS, write_page
from fitter.data.motions import Measured
from fitter.diagnosis.diagnosis import Diagnosis, diagnose
from fitter.diagnosis.judgement import simulated
from limbcal.command import Document, Parser, common_options, run_command
from limbcal.errors import DataError

ARMS = Path(__file__).parent.parent
RECORDING = Path("multiarm_pendulum") / "DoublePendulumDataForParameterEstimation.mat"
STEP_S, HORIZON_S = 1e-3, 2.0
#: The swing is cut into motions of this length, so that whole motions can be held out [s].
PIECE_S = 2.5


def swings(path: Path, cells: str) -> list[Measured]:
    """Return the recording's cells, joined and cut into pieces; angles relative, 0 hanging down.

    Raises
    ------
    DataError
        If the file is missing.
    """
    if not path.exists():
        raise DataError(f"{path}: there is no such file; set LIMBCAL_DATA to the folder of the recordings")
    theta = np.hstack([cell[:2] for cell in scipy.io.loadmat(path)[cells].ravel()])
    q = np.column_stack([theta[0] - np.pi, theta[1] - theta[0]])
    size = round(PIECE_S / STEP_S)
    starts = range(0, len(q) - size + 1, size)
    return [
        Measured(f"{cells}-{k + 1}", str(path), s, STEP_S * np.arange(s, s + size), {"q": q[s : s + size]})
        for k, s in enumerate(starts)
    ]


def prediction_rms_mrad(found: Diagnosis, arm: Arm, learn: bool) -> float:
    """Return the rms error of both absolute angles, simulated for two seconds at a time [mrad]."""
    square: list[Floats] = []
    for motion in found.motions:
        if motion.learn == learn:
            off = np.cumsum(simulated(arm, motion, HORIZON_S) - motion.trial.q, axis=1)
            square.append(np.mean(off**2, axis=0))
    return float(1e3 * np.sqrt(np.mean(square)))


def case(options: argparse.Namespace) -> Document:
    """Diagnose, predict, compare with the published model, write the page."""
    published = load_arm(str(ARMS / "free-pendulum-published.toml"))
    learn, evaluate = (swings(options.data / RECORDING, cells) for cells in ("Y_id", "Y_vad"))
    found = diagnose(published, learn, evaluate, denied=("fc",), free=True)
    finding = found.finding
    rows = [
        (name, prediction_rms_mrad(found, arm, True), prediction_rms_mrad(found, arm, False))
        for name, arm in (
            ("published, viscous", published),
            ("viscous, learnt again", finding.base_arm),
            ("with what was found", finding.arm),
        )
    ]
    write_page(
        options.out / "multiarm-pendulum.md",
        title="A free double pendulum",
        lead=(
            "A passive double pendulum (MultiArm-Pendulum, MIT), encoders only, 70 s to learn from and 10 s held back. "
            "The published model has viscous friction and nothing else. No torque drives it, so everything is in "
            "units of the second link's inertia, taken as published."
        ),
        command="python -m examples.cases.multiarm_pendulum",
        found=found,
        table=(("model", "learnt from [mrad]", "held back [mrad]"), rows),
        caption="Error of a prediction of 2 s, rms over both absolute angles.",
    )
    return {"prediction_rms_mrad": {name: {"learn": a, "evaluate": b} for name, a, b in rows}} | finding.document()


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    parser = Parser(prog="multiarm_pendulum", description=__doc__, parents=[common_options()])
    parser.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="folder of the recordings")
    parser.add_argument("--out", type=Path, default=DOCS, metavar="DIR", help="where the page goes (docs/cases)")
    parser.set_defaults(action=case)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
