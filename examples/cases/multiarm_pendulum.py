"""A double pendulum that swings freely, diagnosed: what its published, viscous model lacks.

``python -m examples.cases.multiarm_pendulum`` writes ``docs/cases/multiarm-pendulum.md`` and its picture. The
recording is that of the MultiArm-Pendulum repository (MIT): 69 s to learn from, 11 s held back.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from arm.arm_file import load_arm
from arm.model import Arm, Floats
from arm.simulation import simulate
from examples.cases.case_page import DATA, DOCS, FigureTable, Page, write_page
from examples.cases.motion_fit import refined
from examples.cases.search import MOST, find
from examples.free_pendulum import HORIZON_S, RECORDING, prediction_rms_mrad, swings
from fitter.data.motions import Measured
from fitter.data.trials import Trial
from fitter.report.diagnosis_words import candidate_name
from limbcal.command import Document, Parser, common_options, run_command

ARMS = Path(__file__).parent.parent
RATE_HZ = 200.0
#: Column of the second link's inertia among the standard parameters, and its published value [kg m^2].
SCALE = (12, 0.003146173824)
#: The swing is cut into motions of this length, so that whole motions can be held out [s].
PIECE_S = 2.5
#: Every so manieth sample is simulated and compared while numbers are fitted to the motion.
STRIDE = 4
ASKED_MRAD, PUBLISHED_MRAD = 1.25, 3.23


def pieces(trial: Trial, every: int = 1) -> list[Measured]:
    """Return a swing cut into motions, all or every so manieth."""
    q = trial.whole["q"]
    size = round(PIECE_S / trial.dt_s)
    starts = range(0, len(q) - size + 1, size * every)
    return [
        Measured(
            f"{trial.name}-{s // size + 1}", "", s, trial.dt_s * np.arange(s, s + size), {"q": q[s : s + size]}
        )
        for s in starts
    ]


def prediction_errors(arm: Arm, trial: Trial, every: int = 1) -> Floats:
    """Return simulated less measured absolute angles, two seconds at a time, flat [rad].

    Parameters
    ----------
    arm : Arm
    trial : Trial
    every : int
        Only every so manieth stretch of two seconds counts.
    """
    size = STRIDE * round(HORIZON_S / trial.dt_s / STRIDE)
    off = []
    for start in range(0, len(trial.q) - size, size * every):
        q = trial.q[start : start + size + 1 : STRIDE]
        motion = simulate(
            arm, q, STRIDE * trial.dt_s, q[0], trial.dq[start], torque=np.zeros_like(q), t0_s=trial.t[start]
        )
        off.append(np.cumsum(motion.q - q, axis=1))
    return np.concatenate(off).ravel()


def case(options: argparse.Namespace) -> Document:
    """Diagnose, predict, compare with the published model, write the page."""
    published = load_arm(str(ARMS / "free-pendulum-published.toml"))
    learn, held_back = (swings(options.data / RECORDING, cells) for cells in ("Y_id", "Y_vad"))
    found = find(
        published,
        pieces(learn, options.every),
        pieces(held_back),
        denied=("fc",),
        known=SCALE,
        rate_hz=options.rate_hz,
        most=options.most,
    )
    listed = found.steps
    models = [("published, viscous", published)]
    models += [
        (f"+ {candidate_name(step.hypothesis)}" if step.hypothesis else "viscous, fitted anew", step.arm)
        for step in listed
    ]
    moved = refined(listed[-1].arm, lambda arm: prediction_errors(arm, learn, options.every), known_inertia=True)
    models.append(("the same causes, numbers fitted to the motion", moved))
    errors = [(name, *(_rms(arm, trial) for trial in (learn, held_back))) for name, arm in models]
    last = errors[-1][2]
    page = Page(
        name="multiarm-pendulum",
        title="A free double pendulum: what its published model lacks",
        lead=(
            "A passive double pendulum ([MultiArm-Pendulum](https://github.com/dynamicslab/MultiArm-Pendulum), "
            "MIT), "
            "encoders only, 69 s to learn from (`Y_id`) and 11 s held back (`Y_vad`). The published model has "
            "viscous "
            "friction and nothing else. No torque drives it, so everything is in units of the second link's "
            "inertia, "
            "taken as published."
        ),
        module="multiarm_pendulum",
        tables=[
            FigureTable(
                "Error of a prediction of 2 s, rms over both absolute angles [mrad]. Up to the last row, "
                "numbers are "
                "those of the equation of motion, which is what a diagnosis fits; in the last row the same causes "
                "have their numbers, and those of the links, moved until predictions of 2 s on `Y_id` are best "
                "(`examples/cases/motion_fit.py`). "
                f"Published, seen elsewhere: {PUBLISHED_MRAD} held back. Asked: no worse than {ASKED_MRAD}; "
                "measured: "
                f"{last:.2f}, {'which is met' if last <= ASKED_MRAD else 'which is missed'}.",
                ("model", "learnt from", "held back"),
                [(name, f"{a:.2f}", f"{b:.2f}") for name, a, b in errors],
            )
        ],
        left=[
            "The recording tells nothing of absolute masses, and angles of both links are read by encoders "
            "whose own "
            "faults (eccentric discs, say) would look like ripples of torque."
        ],
    )
    write_page(page, found, options.out)
    return {"prediction_rms_mrad": {name: {"learn": a, "evaluate": b} for name, a, b in errors}} | found.document()


def _rms(arm: Arm, trial: Trial) -> float:
    return float(np.sqrt(np.mean(prediction_rms_mrad(arm, trial) ** 2)))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    parser = Parser(prog="multiarm_pendulum", description=__doc__, parents=[common_options()])
    parser.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="folder of the recordings")
    parser.add_argument("--out", type=Path, default=DOCS, metavar="DIR", help="where the page goes (docs/cases)")
    parser.add_argument("--rate-hz", type=float, default=RATE_HZ, help=f"to resample to ({RATE_HZ:g})")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="learn from every N-th piece only (1)")
    parser.add_argument("--most", type=int, default=MOST, metavar="N", help=f"causes at most ({MOST})")
    parser.set_defaults(action=case)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
