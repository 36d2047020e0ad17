"""A small servo that holds a pendulum, diagnosed under its own position control.

``python -m examples.cases.bam_xl330`` writes ``docs/cases/bam-xl330.md`` and its picture. The recordings are those
of the BAM repository (Apache-2.0): an XL330 with 0.49 kg at 0.1 m, three gains; two are learnt from, the third is
held back.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from arm.model import Arm, Control, Floats, Friction, Joint, Link
from arm.simulation import simulate
from examples.cases.case_page import DATA, DOCS, FigureTable, Page, Story, write_page
from examples.cases.motion_search import MOST, causes_told, name_of, search
from fitter.report.diagnosis_figures import AFTER, BEFORE
from fitter.report.figures import MEASURED, png
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command
from limbcal.errors import DataError

FOLDER = "bam_xl330"
LEARN_KP, EVALUATE_KP = (100, 800), 400
#: The servo's gains are numbers without a unit; torque is told in units of what the greatest gives for 1 rad.
UNIT_KP = 800.0
#: Mass and length of the pendulum as they were weighed and measured, and gravity: what the drive's unit is worth.
WEIGHT_N_M = 0.49 * 9.81 * 0.1
#: The simulation's step, and the interval of what is compared [s].
STEP_S = 0.005
#: So many are in every log.
SAMPLES = 1190
ENCODER_MRAD = 1.53
PUBLISHED_MRAD = 34.8
#: What may be missing, and where the search for its numbers starts.
CANDIDATES = {
    "torque_saturation": {"limit_N_m": 0.5},
    "load_friction": {"coefficient": 0.1},
    "stribeck": {"amplitude_N_m": 0.02, "velocity_rad_s": 0.5},
    "actuator_lag": {"time_constant_s": 0.01},
    "torque_offset": {"torque_N_m": 0.001},
    "quadratic_drag": {"drag_N_m_s2": 0.001},
}
#: A pendulum about as heavy as this one, to start from: all its numbers are fitted. 0 hangs down.
START = Arm(
    "xl330",
    (
        Joint(
            a_m=0.1,
            friction=Friction(0.03, 0.02),
            link=Link(0.36, (0.1, 0.0, 0.0), (0.0, 0.0, 0.004, 0.0, 0.0, 0.0)),
        ),
    ),
    gravity_m_s2=(9.81, 0.0, 0.0),
)


@dataclass(frozen=True)
class Log:
    """One recording.

    Attributes
    ----------
    name : str
    gain : float
        Torque in the case's unit per rad.
    t, q, goal : (n_sample,)
        As they were recorded [s], [rad].
    off_s : float
        When the motor is let go; infinite if never.
    """

    name: str
    gain: float
    t: Floats
    q: Floats
    goal: Floats
    off_s: float


def logs(folder: Path, kp: int) -> list[Log]:
    """Return all recordings of one gain.

    Raises
    ------
    DataError
        If there are none.
    """
    paths = sorted(folder.glob(f"kp{kp}_*.json"))
    if not paths:
        raise DataError(f"{folder}: no kp{kp}_*.json; set LIMBCAL_DATA to the folder of the recordings")
    listed = []
    for path in paths:
        content = json.loads(path.read_text(encoding="utf-8"))
        rows = content["entries"]
        t, q, goal = (np.array([row[key] for row in rows]) for key in ("timestamp", "position", "goal_position"))
        off = next((row["timestamp"] for row in rows if not row["torque_enable"]), np.inf)
        listed.append(Log(path.stem, content["kp"] / UNIT_KP, t, q, goal, float(off)))
    return listed


def angle_errors(arm: Arm, log: Log) -> Floats:
    """Return simulated less measured angles of a whole log, from its first instant on, (n_sample,) [rad].

    The servo's law drives the arm until the motor is let go; the arm then falls from where the simulation has it.
    """
    t = log.t[0] + STEP_S * np.arange(SAMPLES)
    goal = log.goal[np.searchsorted(log.t, t, side="right") - 1][:, None]
    driven = replace(arm, control=Control("p", kp=(log.gain,)))
    on = int(np.count_nonzero(t < log.off_s))
    motion = simulate(driven, goal[:on], STEP_S, log.q[:1])
    q = motion.q
    if on < len(t):
        state = motion.q[-1], motion.dq[-1]
        nothing = np.zeros_like(goal[on - 1 :])
        q = np.vstack([q[:-1], simulate(arm, nothing, STEP_S, *state, torque=nothing).q])
    return np.asarray(q[:, 0] - np.interp(t, log.t, log.q), dtype=np.float64)


def case(options: argparse.Namespace) -> Document:
    """Search, simulate every log in closed loop, write the page."""
    folder = options.data / FOLDER
    learn = [log for kp in LEARN_KP for log in logs(folder, kp)][:: options.every]
    evaluate = logs(folder, EVALUATE_KP)
    found = search(
        START, lambda arm: np.array([angle_errors(arm, log) for log in learn]), CANDIDATES, options.most
    )
    names = ["rigid, viscous and Coulomb", *map(name_of, found[1:])]
    errors = [
        (name, *(_sizes(model.arm, some) for some in (learn, evaluate)))
        for name, model in zip(names, found, strict=True)
    ]
    final = found[-1].arm
    mean, rms = errors[-1][2]
    link = final.joints[0].link
    unit = WEIGHT_N_M / (START.gravity_m_s2[0] * link.mass_kg * float(np.hypot(*link.com_m[:2])))
    page = Page(
        name="bam-xl330",
        title="A servo under position control",
        lead=(
            "An XL330 servo holds 0.49 kg at 0.1 m and follows its own position control ([BAM]"
            "(https://github.com/Rhoban/bam), Apache-2.0). Nobody measured a torque: the drive is `kp (goal - "
            "q)`, "
            f"in units of what kp {UNIT_KP:g} gives for 1 rad, and nothing while the motor is let go. Learnt "
            "from: "
            f"{len(learn)} logs at kp {' and '.join(map(str, LEARN_KP))}; judged on the {len(evaluate)} logs at "
            "kp "
            f"{EVALUATE_KP}. The model it starts from is a rigid pendulum with viscous and Coulomb friction whose "
            f"motor obeys. By the pendulum's known weight one unit is {unit:.2f} N m."
        ),
        module="bam_xl330",
        tables=[
            FigureTable(
                "Error of the angle simulated in closed loop over whole logs (6 s), mean absolute / rms [mrad]. "
                "Best "
                f"public result, held out: {PUBLISHED_MRAD} mrad; measured: {mean:.1f} mean absolute, {rms:.1f} "
                "rms. "
                "Which of the two kinds the public figure is was not known here.",
                ("model", "learnt from", f"held back, kp {EVALUATE_KP}"),
                [(name, *(f"{a:.1f} / {b:.1f}" for a, b in both)) for name, *both in errors],
            )
        ],
        left=[
            "The steps of the angle's encoder are 1.5 mrad, the log's interval 5 ms, and the servo's own loop, "
            "its "
            "supply voltage and its temperature are not in the model. What one joint without a torque sensor "
            "says of "
            "friction and of the drive is told by motion alone, so sizes lean on each other."
        ],
    )
    story = Story(
        causes_told(found, CANDIDATES, "unit"),
        f"Angles simulated in closed loop are still off by {mean:.1f} mrad on the mean, some "
        f"{mean / ENCODER_MRAD:.0f} steps of the encoder: the model is not complete.",
        _picture(found[0].arm, final, evaluate),
        "Angles held back: measured (grey), simulated before (orange) and with what was found (green).",
    )
    write_page(page, story, options.out)
    table = {
        name: {part: {"mean": a, "rms": b} for part, (a, b) in zip(("learn", "evaluate"), both, strict=True)}
        for name, *both in errors
    }
    return {"angle_error_mrad": table, "causes": [vars(one) for one in final.effects]}


def _picture(before: Arm, after: Arm, some: Sequence[Log]) -> bytes:
    figure = Figure(figsize=(11, 6), layout="constrained")
    for panel, log in zip(figure.subplots(2, 2).flat, some, strict=True):
        t = log.t[0] + STEP_S * np.arange(SAMPLES)
        q = np.interp(t, log.t, log.q)
        panel.plot(t, q, color=MEASURED, lw=4.0, alpha=0.35)
        for arm, colour in ((before, BEFORE), (after, AFTER)):
            panel.plot(t, q + angle_errors(arm, log), color=colour, lw=1.0)
        panel.set_title(log.name, fontsize=9)
        panel.set_xlabel("time [s]")
        panel.set_ylabel("angle [rad]")
        panel.grid(alpha=0.25)
    return png(figure)


def _sizes(arm: Arm, some: Sequence[Log]) -> tuple[float, float]:
    off = 1e3 * np.concatenate([angle_errors(arm, log) for log in some])
    return float(np.mean(np.abs(off))), float(np.sqrt(np.mean(off**2)))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    parser = Parser(prog="bam_xl330", description=__doc__, parents=[common_options()])
    parser.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="folder of the recordings")
    parser.add_argument("--out", type=Path, default=DOCS, metavar="DIR", help="where the page goes (docs/cases)")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="learn from every N-th log only (1)")
    parser.add_argument("--most", type=int, default=MOST, metavar="N", help=f"causes at most ({MOST})")
    parser.set_defaults(action=case)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
