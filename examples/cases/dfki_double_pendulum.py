"""A measured two-link arm, diagnosed from nothing: a level, frictionless model that has to find gravity first.

``python -m examples.cases.dfki_double_pendulum`` writes ``docs/cases/dfki-double-pendulum.md`` and its picture.
The recordings are those of DFKI's double_pendulum repository, design C.1 (BSD-3-Clause).
"""

import sys
from collections.abc import Sequence

from examples.cases.case_page import Case, run_case

EVALUATE = "20230629-154220"
LEARN = tuple(f"20230629-{run}" for run in ("143339", "143524", "143601", "143704", "143906", "144003"))

CASE = Case(
    name="dfki-double-pendulum",
    title="A measured arm, from a level and frictionless model on",
    lead=(
        "A vertical two-link arm with quasi-direct-drive motors ([double_pendulum]"
        "(https://github.com/dfki-ric-underactuated-lab/double_pendulum), design C.1, BSD-3-Clause), torque from "
        "motor current. The model that it starts from lies on a table, for its gravity points out of the plane of "
        f"motion, and its joints are without friction. Learnt from: {len(LEARN)} runs of 2023-06-29; held back: "
        f"the swing-up `{EVALUATE}`."
    ),
    folder="dfki_double_pendulum",
    command=(
        *(f"{{data}}/{run}.csv" for run in LEARN),
        "--evaluate",
        f"{{data}}/{EVALUATE}.csv",
        "--arm",
        "{arms}/dfki-level.toml",
        "--deny",
        "viscous,coulomb",
        "--columns",
        "t=time,q=pos_meas{j},tau=tau_meas{j}",
    ),
    picture="residual",
    caption="The missing torque of the swing-up held back, before (orange) and after (green).",
    remarks=(
        "The torque is that of the motors' current, so part of the residual may be no torque at all. In "
        "`20230629-143906` the elbow hardly moves.",
    ),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the case."""
    return run_case(CASE, argv)


if __name__ == "__main__":
    sys.exit(main())
