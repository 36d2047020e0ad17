"""A double pendulum that swings freely, diagnosed: what a model with viscous and Coulomb friction lacks.

``python -m examples.cases.multiarm_pendulum`` writes ``docs/cases/multiarm-pendulum.md`` and its picture. The
recording is that of the MultiArm-Pendulum repository (MIT): 69 s to learn from, 11 s held back.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from arm.arm_file import load_arm
from examples.cases.case_page import ARMS, Case, run_case
from examples.free_pendulum import HORIZON_S, RECORDING, best_start_rms_mrad, prediction_rms_mrad, swings

COLUMNS = "t=0.001,q1={cells}(join)[1]-pi,q2={cells}(join)[2]-{cells}(join)[1]"

CASE = Case(
    name="multiarm-pendulum",
    title="A free double pendulum",
    lead=(
        "A passive double pendulum ([MultiArm-Pendulum](https://github.com/dynamicslab/MultiArm-Pendulum), MIT), "
        "encoders only, 69 s to learn from (`Y_id`) and 11 s held back (`Y_vad`). No torque drives it, so "
        "everything is in units of the second link's inertia, taken as published."
    ),
    folder=RECORDING.parent.name,
    command=(
        f"{{data}}/{RECORDING.name}",
        "--evaluate",
        f"{{data}}/{RECORDING.name}",
        "--no-torque",
        "--horizon",
        f"{HORIZON_S:g}",
        "--arm",
        "{arms}/free-pendulum.toml",
        "--columns",
        COLUMNS.replace("{cells}", "Y_id"),
        "--evaluate-columns",
        COLUMNS.replace("{cells}", "Y_vad"),
    ),
    picture="residual",
    caption="The missing torque of the swing held back, before (orange) and after (green).",
    remarks=(
        "The recording tells nothing of absolute masses, and both angles are read by encoders whose own faults "
        "(eccentric discs, say) would look like ripples of torque.",
    ),
)


def predictions(folder: Path, data: Path) -> list[str]:
    """Return lines on how far predictions of 2 s go astray, with what was found and as published."""
    arms = {"published": ARMS / "free-pendulum-published.toml", "with the causes": folder / "extended.toml"}
    lines = [f"Error of a prediction of {HORIZON_S:g} s, rms over both absolute angles [mrad]:", ""]
    lines += ["| | learnt from | held back | held back, from the start that goes best |", "|---|---|---|---|"]
    learnt, held_back = (swings(data / RECORDING, cells) for cells in ("Y_id", "Y_vad"))
    for name, path in arms.items():
        arm = load_arm(str(path))
        errors = [prediction_rms_mrad(arm, learnt), prediction_rms_mrad(arm, held_back)]
        errors.append(best_start_rms_mrad(arm, held_back))
        lines.append(f"| {name} | {' | '.join(f'{np.sqrt(np.mean(one**2)):.2f}' for one in errors)} |")
    return [*lines, ""]


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    return run_case(CASE, argv, predictions)


if __name__ == "__main__":
    sys.exit(main())
