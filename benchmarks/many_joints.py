"""The torque regressor of arms with many joints, beside pinocchio's: a chain of 7, and trees and a chain of 30.

A body's tree is a trunk of six joints with four limbs of six. Rows are made a few samples at a time, as the sums
take them, and kept for all samples at once; pinocchio makes those of one sample at a time and keeps none. Kept
rows of 30 joints are 86 kB a sample: to clear that much memory takes about as long as pinocchio's computation.
Times are the processor's, of one thread.
"""

import argparse
import sys
from collections.abc import Sequence
from functools import partial

import numpy as np
import pinocchio as pin

from arm.chain import chain_of
from arm.model import Arm, Floats, Joint
from arm.regressor import regressor, torque_rows
from arm.regressor_lanes import LANES
from benchmarks.pinocchio_model import pinocchio_model
from benchmarks.timing import seconds
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, emit, run_command

#: Samples of which the rows are made.
SAMPLES = 1000
#: Which link each joint hangs on, counted from 1; 0 is the base.
TREES = {
    "chain of 7": range(7),
    "body of 30": (*range(6), *(6 if k % 6 == 0 else 6 + k for k in range(24))),
    "six limbs of 5": [0 if k % 5 == 0 else k for k in range(30)],
    "chain of 30": range(30),
}


def arm_of(parents: Sequence[int]) -> Arm:
    """Return an arm whose joints turn about axes that are square to their parents'."""
    joints = [Joint(a_m=0.2, alpha_rad=0.5 * np.pi * (-1) ** k, parent=on) for k, on in enumerate(parents)]
    return Arm("benchmark", tuple(joints))


def times(arm: Arm, samples: int) -> dict[str, float]:
    """Return how long one sample's rows take [us]: pinocchio's, ours a few at a time, ours kept."""
    n, model = arm.n_joint, pinocchio_model(arm)
    data, chain = model.createData(), chain_of(arm)
    q, dq, ddq = np.random.default_rng(0).normal(size=(3, samples, n))
    room = np.zeros((LANES, n, 12 * n))

    def peer() -> None:
        for k in range(samples):
            pin.computeJointTorqueRegressor(model, data, q[k], dq[k], ddq[k])

    def in_turn() -> None:
        for k in range(0, samples, LANES):
            torque_rows(chain, q[k : k + LANES], dq[k : k + LANES], ddq[k : k + LANES], room)

    _require_same(regressor(arm, q[:1], dq[:1], ddq[:1])[0], model, q[0], dq[0], ddq[0])
    jobs = {"pinocchio": peer, "rows": in_turn, "kept": partial(regressor, arm, q, dq, ddq)}
    return {name: 1e6 * seconds(job) / samples for name, job in jobs.items()}


def _require_same(Y: Floats, model: pin.Model, q: Floats, dq: Floats, ddq: Floats) -> None:
    """Make sure that both are asked the same question: the columns of all masses are alike."""
    n = len(q)
    theirs = pin.computeJointTorqueRegressor(model, model.createData(), q, dq, ddq)
    if not np.allclose(theirs[:, ::10], Y[:, 9 : 10 * n : 10], atol=1e-9):
        raise AssertionError("pinocchio's arm is another one")


def show(options: argparse.Namespace) -> Document:
    """Measure, and print a table."""
    found = {name: times(arm_of(parents), options.samples) for name, parents in TREES.items()}
    if not options.json:
        emit("| joints | pinocchio | rows | rows kept | times our rows | times those kept |")
        for name, one in found.items():
            ratios = [one["pinocchio"] / one[kind] for kind in ("rows", "kept")]
            took = " | ".join(f"{one[kind]:.2f} us" for kind in ("pinocchio", "rows", "kept"))
            emit(f"| {name} | {took} | {ratios[0]:.1f} | {ratios[1]:.1f} |")
    return {"samples": options.samples, "lanes": LANES, "us_a_sample": found}


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark."""
    parser = Parser(prog="python -m benchmarks.many_joints", description=__doc__, parents=[common_options()])
    parser.add_argument("--samples", type=int, default=SAMPLES, help=f"({SAMPLES})")
    parser.set_defaults(action=show)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
