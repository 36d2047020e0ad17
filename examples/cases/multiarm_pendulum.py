"""A double pendulum that swings freely, diagnosed: what its published, viscous model lacks.

``python -m examples.cases.multiarm_pendulum`` writes ``docs/cases/multiarm-pendulum.md`` and its picture. The
recording is that of the MultiArm-Pendulum repository (MIT): 69 s to learn from, 11 s held back.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from arm.arm_file import load_arm
from arm.model import Arm, Floats
from arm.simulation import simulate
from examples.cases.case_page import DATA, DOCS, FigureTable, Page, Story, write_page
from examples.cases.motion_search import MOST, causes_told, name_of, search
from examples.free_pendulum import HORIZON_S, RECORDING, prediction_rms_mrad, swings
from fitter.data.trials import Trial
from fitter.dynamics.evaluation import motion_error
from fitter.report.diagnosis_figures import AFTER, BEFORE
from fitter.report.figures import png
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command

ARMS = Path(__file__).parent.parent
#: What may be missing, and where the search for its numbers starts: a torque of some 1e-4 N m at 5 rad/s.
CANDIDATES = {
    "coulomb": {"coulomb_N_m": 1e-4},
    "quadratic_drag": {"drag_N_m_s2": 4e-6},
    "air_drag": {"drag_N_m_s2": 4e-6},
    "stribeck": {"amplitude_N_m": 5e-5, "velocity_rad_s": 5.0},
    "torque_offset": {"torque_N_m": 1e-5},
    "coulomb_asymmetry": {"difference_N_m": 1e-5},
}
#: Every so manieth sample is simulated and compared while numbers are fitted to the motion.
STRIDE = 8
ASKED_MRAD, PUBLISHED_MRAD = 1.25, 3.23


def prediction_errors(arm: Arm, trial: Trial, every: int = 1) -> Floats:
    """Return simulated less measured absolute angles, two seconds at a time, (n_stretch, n) [rad].

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
        off.append(np.cumsum(motion.q - q, axis=1).ravel())
    return np.array(off)


def case(options: argparse.Namespace) -> Document:
    """Search, predict, compare with the published model, write the page."""
    published = load_arm(str(ARMS / "free-pendulum-published.toml"))
    learn, held_back = (swings(options.data / RECORDING, cells) for cells in ("Y_id", "Y_vad"))
    found = search(
        published, lambda arm: prediction_errors(arm, learn, options.every), CANDIDATES, options.most, True
    )
    errors = [("published, viscous", _rms(published, learn), _rms(published, held_back))]
    names = ["viscous, fitted to the motion", *map(name_of, found[1:])]
    errors += [
        (name, _rms(model.arm, learn), _rms(model.arm, held_back))
        for name, model in zip(names, found, strict=True)
    ]
    last, final = errors[-1][2], found[-1]
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
            "taken as published. "
            + ("" if options.every == 1 else f"One in {options.every} stretches of 2 s is learnt from.")
        ),
        module="multiarm_pendulum",
        tables=[
            FigureTable(
                "Error of a prediction of 2 s, rms over both absolute angles [mrad]. "
                f"Published, seen elsewhere: {PUBLISHED_MRAD} held back. Asked: no worse than {ASKED_MRAD}; "
                "measured: "
                f"{last:.2f}, {'which is met' if last <= ASKED_MRAD else 'which is missed'}.",
                ("model", "learnt from", "held back"),
                [(name, f"{a:.2f}", f"{b:.2f}") for name, a, b in errors],
            )
        ],
        left=[
            "The recording tells nothing of absolute masses, and both angles are read by encoders whose own "
            "faults "
            "(eccentric discs, say) would look like ripples of torque. No cause is named by its prediction "
            "alone with "
            "certainty: drag and dry friction in two bearings share most of what either explains.",
            "A negative `coulomb` beside `stribeck` says that friction falls with speed further than by that "
            "formula. "
            "`air_drag` and `stribeck` became candidates after a first search without them (1.41 mrad) had been "
            "seen: what is held back had no say in the fit, but in what was tried.",
        ],
    )
    effects = [
        {"effect": one.name, "joints": list(one.joints), "parameters": one.parameters} for one in final.arm.effects
    ]
    story = Story(
        causes_told(found, CANDIDATES),
        f"A prediction of 2 s is still off by {last:.2f} mrad rms held back and {errors[-1][1]:.2f} on the "
        "swing that "
        "was learnt from, far above the encoders' noise of 0.04 mrad. More than that no effect tried "
        "took away.",
        _picture(published, final.arm, held_back),
        "Error of predictions of 2 s on the swing held back, published model (orange) and with what was found "
        "(green).",
    )
    write_page(page, story, options.out)
    return {"prediction_rms_mrad": {name: {"learn": a, "evaluate": b} for name, a, b in errors}} | {
        "causes": effects
    }


def _picture(before: Arm, after: Arm, trial: Trial) -> bytes:
    figure = Figure(figsize=(9, 4), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True)
    for arm, colour in ((before, BEFORE), (after, AFTER)):
        off = 1e3 * np.cumsum(motion_error(arm, trial, HORIZON_S), axis=1)
        for j, panel in enumerate(axes):
            panel.plot(trial.t, off[:, j], color=colour, lw=1.0)
            panel.set_ylabel(f"link {j + 1} [mrad]")
            panel.grid(alpha=0.25)
    axes[1].set_xlabel("time of the swing held back [s]")
    return png(figure)


def _rms(arm: Arm, trial: Trial) -> float:
    return float(np.sqrt(np.mean(prediction_rms_mrad(arm, trial) ** 2)))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    parser = Parser(prog="multiarm_pendulum", description=__doc__, parents=[common_options()])
    parser.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="folder of the recordings")
    parser.add_argument("--out", type=Path, default=DOCS, metavar="DIR", help="where the page goes (docs/cases)")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="learn from every N-th stretch only (1)")
    parser.add_argument("--most", type=int, default=MOST, metavar="N", help=f"causes at most ({MOST})")
    parser.set_defaults(action=case)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
