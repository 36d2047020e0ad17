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

from arm.arm_file import load_arm
from arm.model import Arm, Control, Floats
from arm.simulation import simulate
from examples.cases.case_page import DATA, DOCS, FigureTable, Page, write_page
from examples.cases.motion_fit import refined
from examples.cases.search import MOST, find
from fitter.data.motions import Measured
from fitter.report.diagnosis_words import candidate_name
from limbcal.command import Document, Parser, common_options, run_command
from limbcal.errors import DataError

ARM = Path(__file__).parent.parent / "xl330.toml"
FOLDER = "bam_xl330"
LEARN_KP, EVALUATE_KP = (100, 800), 400
#: The servo's gains are numbers without a unit; torque is told in units of what the greatest gives for 1 rad.
UNIT_KP = 800.0
#: Mass and length of the pendulum as they were weighed and measured, and gravity: what the drive's unit is worth.
WEIGHT_N_M = 0.49 * 9.81 * 0.1
RATE_HZ = 190.0
SET_ASIDE = ("load_friction",)
#: The simulation's step, and the interval of what is compared [s].
STEP_S = 0.005
PUBLISHED_MRAD = 34.8


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

    @property
    def measured(self) -> Measured:
        """The log as a motion with the torque that the law asks for."""
        u = np.where(self.t < self.off_s, self.gain * (self.goal - self.q), 0.0)
        return Measured(self.name, self.name, 0, self.t, {"q": self.q[:, None], "tau": u[:, None]})


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
    t = np.arange(log.t[0], log.t[-1], STEP_S)
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
    """Diagnose, simulate every log in closed loop, write the page."""
    folder = options.data / FOLDER
    learn = [log for kp in LEARN_KP for log in logs(folder, kp)][:: options.every]
    evaluate = logs(folder, EVALUATE_KP)
    arm = load_arm(str(ARM))
    found = find(
        arm,
        [one.measured for one in learn],
        [one.measured for one in evaluate],
        rate_hz=options.rate_hz,
        most=options.most,
        set_aside=SET_ASIDE if options.without_load else (),
    )
    listed = found.steps
    models = [
        (f"+ {candidate_name(step.hypothesis)}" if step.hypothesis else "rigid, viscous and Coulomb", step.arm)
        for step in listed
    ]
    moved = refined(listed[-1].arm, lambda arm: np.concatenate([angle_errors(arm, log) for log in learn]))
    models.append(("the same causes, numbers fitted to the motion", moved))
    errors = [(name, *(_sizes(arm, some) for some in (learn, evaluate))) for name, arm in models]
    mean, rms = errors[-1][2]
    weight = listed[-1].arm.joints[0].link
    unit = WEIGHT_N_M / (9.81 * weight.mass_kg * float(np.hypot(*weight.com_m[:2])))
    page = Page(
        name="bam-xl330",
        title="A servo under position control",
        lead=(
            "An XL330 servo holds 0.49 kg at 0.1 m and follows its own position control ([BAM]"
            "(https://github.com/Rhoban/bam), Apache-2.0). Nobody measured a torque: the drive is `kp (goal - "
            "q)`, in "
            f"units of what kp {UNIT_KP:g} gives for 1 rad, and nothing while the motor is let go. Learnt from: "
            f"{len(learn)} logs at kp {' and '.join(map(str, LEARN_KP))}; judged on the {len(evaluate)} logs at "
            "kp "
            f"{EVALUATE_KP}. The model it starts from is a rigid pendulum with viscous and Coulomb friction "
            "whose motor "
            f"obeys. By the known weight of the pendulum one unit is {unit:.2f} N m."
        ),
        module="bam_xl330",
        tables=[
            FigureTable(
                "Error of the angle simulated in closed loop over whole logs (6 s), mean absolute / rms [mrad]. "
                "Up to "
                "the last row, numbers are those of the equation of motion; in the last row the same causes have "
                "their numbers moved until the simulated angles of the learning logs fit best "
                "(`examples/cases/motion_fit.py`). "
                f"Best public result, held out: {PUBLISHED_MRAD} mrad; measured: {mean:.1f} mean absolute, "
                f"{rms:.1f} rms.",
                ("model", "learnt from", f"held back, kp {EVALUATE_KP}"),
                [(name, *(f"{a:.1f} / {b:.1f}" for a, b in both)) for name, *both in errors],
            )
        ],
        left=[
            "The steps of the angle's encoder are 1.5 mrad, the log's interval 5 ms, and the servo's own loop, "
            "its "
            "supply and its temperature are not in the model. Where its voltage limit ends and friction begins, "
            "one "
            "joint without a torque sensor tells but weakly."
        ],
        unit="unit",
    )
    write_page(page, found, options.out)
    return {
        "angle_error_mrad": {
            name: {part: {"mean": a, "rms": b} for part, (a, b) in zip(("learn", "evaluate"), both, strict=True)}
            for name, *both in errors
        }
    } | found.document()


def _sizes(arm: Arm, some: Sequence[Log]) -> tuple[float, float]:
    off = 1e3 * np.concatenate([angle_errors(arm, log) for log in some])
    return float(np.mean(np.abs(off))), float(np.sqrt(np.mean(off**2)))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    parser = Parser(prog="bam_xl330", description=__doc__, parents=[common_options()])
    parser.add_argument("--data", type=Path, default=DATA, metavar="DIR", help="folder of the recordings")
    parser.add_argument("--out", type=Path, default=DOCS, metavar="DIR", help="where the page goes (docs/cases)")
    parser.add_argument("--rate-hz", type=float, default=RATE_HZ, help=f"to resample to ({RATE_HZ:g})")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="learn from every N-th log only (1)")
    parser.add_argument("--most", type=int, default=MOST, metavar="N", help=f"causes at most ({MOST})")
    parser.add_argument("--without-load", action="store_true", help="leave friction of the load aside")
    parser.set_defaults(action=case)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
