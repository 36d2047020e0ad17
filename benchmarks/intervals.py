"""Do the intervals hold? The virtual arm, many times over: readings, tracker, fit, and (found - true) / std.

No socket and no process lies between the readings and the fit, so that a seed takes seconds.
"""

import argparse
import json
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np

from arm.arm_file import load_arm
from arm.base_parameters import base_parameters
from arm.counts import COUNT_M_S2
from arm.model import Arm
from arm.regressor import standard_parameters
from daemon.publishing.motion_blocks import frame_blocks, frames_message
from daemon.virtual_device.virtual_motion import BenchPlan, stretches
from fitter.kinematics.tip_basis import geometry_names, geometry_of
from fitter.live.calibration import Calibration
from fitter.live.stream import MotionAssembler
from protocol.message import FRAMES, TRIAL
from tracking.tracker import Tracker, tracker_of

RATE_HZ, BLOCK = 32000.0, 32 * 32


def truth_of(arm: Arm) -> dict[str, float]:
    """Return the true value of every parameter that a fit may report."""
    base = base_parameters(arm)
    values = base.combination @ standard_parameters(arm)
    geometry = dict(zip(geometry_names(arm.n_joint), geometry_of(arm).ravel().tolist(), strict=True))
    return geometry | dict(zip(base.names, values.tolist(), strict=True))


def messages(arm: Arm, tracker: Tracker, plan: BenchPlan) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield what a daemon would publish of the planned motions."""
    sample = 0
    rests = 0
    for stretch in stretches(plan):
        rests += stretch.trial == 0
        if rests > 1:
            break
        readings = stretch.counts * COUNT_M_S2
        for k in range(0, len(readings), BLOCK):
            frames, phases = tracker.push(round(sample / RATE_HZ * 1e9), readings[k : k + BLOCK])
            sample += len(readings[k : k + BLOCK])
            for piece in frames:
                for block in frame_blocks(piece):
                    yield FRAMES, frames_message(block, tracker.method) | {"run": "benchmark"}
            for phase in phases:
                fields = {"trial": phase.trial, "t_ns": phase.t_ns, "state": phase.kind, "role": "learn"}
                yield TRIAL, fields | {"run": "benchmark"}


def found(calibration: Calibration) -> dict[str, tuple[float, float, tuple[float, float] | None]]:
    """Return value, standard error and interval of each parameter that has one."""
    fits = [fit for fit in (calibration.kinematics(), calibration.dynamics) if fit is not None]
    return {
        name: (p.value, p.std, p.ci95)
        for fit in fits
        for name, p in fit.parameters.items()
        if p.identifiable and np.isfinite(p.std)
    }


def run(seed: int, arguments: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Yield what is found of one virtual arm, after each motion and at the end."""
    true_arm, arm = load_arm(arguments.true_arm), load_arm(arguments.arm)
    truth = truth_of(true_arm)
    q0 = None
    tracker = tracker_of(arm, arguments.method, RATE_HZ, q0, 1000.0)
    plan = BenchPlan(true_arm, seed, RATE_HZ, arguments.motions, arguments.noise, arguments.imperfect_mounting)
    calibration, assembler = Calibration(arm, seed), MotionAssembler()

    def row(stage: str, began: float) -> dict[str, Any]:
        parameters = {}
        for name, (value, std, ci) in found(calibration).items():
            if name in truth:
                inside = ci is not None and ci[0] <= truth[name] <= ci[1]
                parameters[name] = {"value": value, "std": std, "z": (value - truth[name]) / std, "inside": inside}
        seconds = time.perf_counter() - began
        return {"seed": seed, "stage": stage, "seconds": seconds, "parameters": parameters}

    for topic, fields in messages(arm, tracker, plan):
        motion = assembler.feed(topic, fields)
        if motion is None:
            continue
        began = time.perf_counter()
        calibration.add(motion)
        calibration.learn_dynamics()
        yield row(f"live {len(calibration.learn)}", began)
    began = time.perf_counter()
    calibration.conclude()
    yield row("final", began)


def table(rows: list[dict[str, Any]], stage: str) -> str:
    """Return rms z, share inside 95 % and the largest z of every parameter and of all."""
    by_name: dict[str, list[tuple[float, bool, float]]] = defaultdict(list)
    for row in rows:
        if row["stage"].startswith(stage):
            for name, p in row["parameters"].items():
                by_name[name].append((p["z"], p["inside"], p["std"]))
    lines = [f"{stage}: parameter, n, rms z, mean z, inside 95 %, largest |z|, median std"]
    everything = [one for some in by_name.values() for one in some]
    for name, some in [*by_name.items(), ("all", everything)]:
        if some:
            z, inside, std = map(np.array, zip(*some, strict=True))
            lines.append(
                f"  {name:>14} {len(z):4d} {np.sqrt(np.mean(z**2)):7.2f} {z.mean():+7.2f} "
                f"{100 * inside.mean():6.1f} {np.abs(z).max():7.2f} {np.median(std):10.2g}"
            )
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="0-7", help="FROM-TO (0-7)")
    parser.add_argument("--motions", type=int, default=5, help="learning motions (5)")
    parser.add_argument("--method", choices=["filter", "integrate"], default="filter")
    parser.add_argument("--arm", default="examples/lab-arm.toml", help="what the lab knows")
    parser.add_argument("--true-arm", default="dd-arm", help="what there is")
    parser.add_argument("--noise", type=float, default=1.0, help="factor on white noise and bias (1)")
    parser.add_argument("--imperfect-mounting", action="store_true")
    parser.add_argument("--json", action="store_true", help="one line a stage and seed")
    arguments = parser.parse_args(argv)
    first, _, last = arguments.seeds.partition("-")
    rows = []
    for seed in range(int(first), int(last or first) + 1):
        for one in run(seed, arguments):
            rows.append(one)
            z = {name: round(p["z"], 2) for name, p in one["parameters"].items()}
            line = f"{seed} {one['stage']} {one['seconds']:.2f} s {z}"
            sys.stdout.write(f"{json.dumps(one) if arguments.json else line}\n")
            sys.stdout.flush()
    for stage in ("live 1", "live 2", "live 5", "live", "final"):
        (sys.stderr if arguments.json else sys.stdout).write(table(rows, stage) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
