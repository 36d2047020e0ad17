"""A small servo that holds a pendulum, diagnosed under its own position control.

``python -m examples.cases.bam_xl330`` writes ``docs/cases/bam-xl330.md`` and its picture. The recordings are those
of the BAM repository (Apache-2.0): an XL330 with 0.49 kg at 0.1 m, three gains; two are learnt from, the third is
held back.
"""

import sys
from collections.abc import Sequence

from examples.cases.case_page import Case, run_case

MOTIONS = ("lift_and_drop", "sin_sin", "sin_time_square", "up_and_down")
LEARN_KP, EVALUATE_KP = (100, 800), 400

CASE = Case(
    name="bam-xl330",
    title="A servo under position control",
    lead=(
        "An XL330 servo holds 0.49 kg at 0.1 m and follows its own position control ([BAM]"
        "(https://github.com/Rhoban/bam), Apache-2.0). Nobody measured a torque: the drive is `kp (goal - q)`, in "
        "units of what kp 800 gives for 1 rad, and nothing while the motor is let go. Learnt from: the logs at kp "
        f"{' and '.join(map(str, LEARN_KP))}; held back: those at kp {EVALUATE_KP}. The base model is a rigid "
        "pendulum with viscous and Coulomb friction whose motor obeys."
    ),
    folder="bam_xl330",
    command=(
        *(f"{{data}}/kp{kp}_{motion}.json" for kp in LEARN_KP for motion in MOTIONS),
        "--evaluate",
        *(f"{{data}}/kp{EVALUATE_KP}_{motion}.json" for motion in MOTIONS),
        "--arm",
        "{arms}/xl330-pendulum.toml",
        "--columns",
        "t=entries.timestamp,q=entries.position,ref=entries.goal_position,on=entries.torque_enable,kp=kp/800",
    ),
    picture="angles",
    caption="Angles held back: measured (grey), simulated before (orange) and with what was found (green).",
    unit="unit",
    remarks=(
        "Simulated angles are those of whole logs in closed loop. The encoder's steps are 0.09°, the log's "
        "interval is 5 ms; the servo's own loop, its supply voltage and its temperature are not in the model.",
    ),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    return run_case(CASE, argv)


if __name__ == "__main__":
    sys.exit(main())
