"""How often `fitter sensors` finds sensors that are mounted otherwise than the arm file says.

In the file each sensor is turned into one of the 24 ways that axes can be exchanged and reversed, and each place
and length is wrong by up to 30 %. `fitter sensors` learns from one motion of the bench. What it writes is judged
by the true axes, by the lengths that it says it found, and by the angles of another motion. Where that one begins
is given: the angle of an upright axis shows in no gravity.

    python -m benchmarks.mountings --draws 100

Results are those of one commit: ``benchmarks/results/mountings-<commit>.jsonl``, a line a draw, and ``….md``.
"""

import argparse
import contextlib
import io
import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from arm.arm_file import load_arm, save_arm
from arm.counts import COUNT_M_S2
from arm.kinematics import rotation_from_rpy
from arm.model import Arm, Floats
from benchmarks.case_pool import Line, timed
from benchmarks.case_results import add_pool_options, run_kept, show_page
from benchmarks.diagnosis_page import table
from benchmarks.record import commit
from benchmarks.tracking import Case, Recording, record
from fitter.__main__ import main as fitter
from fitter.data.motion_file import write_motion
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command
from tracking.smoother.orientations import right_angles, turned

#: Arms whose sensors feel gravity turn: without it no axis is known from rest.
ARMS = ("dd-arm-vertical", "spatial-arm")
#: Places and lengths of the file are wrong by up to this ratio.
WRONG = 0.3
#: Samples in a mean: readings of 1 kHz.
STRIDE = 32
#: A sensor's axes are right within this angle [deg], far less than the 90 between two ways.
RIGHT_DEG = 10.0
#: A length holds within this many of its own standard errors.
SIGMAS = 3.0


@dataclass(frozen=True)
class Job:
    """One draw."""

    arm: str
    seed: int

    @property
    def key(self) -> str:
        """What the results file calls it."""
        return f"{self.arm}/{self.seed}"


def garbled(arm: Arm, rng: np.random.Generator) -> Arm:
    """Return what the file says: axes by one of 24 ways a sensor, places and lengths by up to 30 % wrong."""
    ways = tuple(rng.integers(0, len(right_angles()), len(arm.sensors)).tolist())
    sensors = tuple(
        replace(one, position_m=tuple((np.array(one.position_m) * _factors(rng, 3)).tolist()))
        for one in turned(arm, ways).sensors
    )
    joints = tuple(
        replace(one, a_m=one.a_m * float(a), d_m=one.d_m * float(d))
        for one, (a, d) in zip(arm.joints, _factors(rng, 2 * arm.n_joint).reshape(-1, 2), strict=True)
    )
    return replace(arm, sensors=sensors, joints=joints)


def _factors(rng: np.random.Generator, n: int) -> Floats:
    return rng.uniform(1.0 - WRONG, 1.0 + WRONG, n)


@cache
def _recording(arm: str, seed: int) -> Recording:
    return record(Case(arm), seed, 2)


def write(path: Path, arm: Arm, recording: Recording, part: slice, truth: bool) -> None:
    """Write means of readings as `fitter` reads them, with the true angles or without."""
    n = len(recording.counts[part]) // STRIDE
    means = COUNT_M_S2 * recording.counts[part][: n * STRIDE].reshape(n, STRIDE, -1).mean(axis=1)
    t = (np.arange(n) + 0.5) * STRIDE / recording.rate_hz
    q = recording.q[part][: n * STRIDE].reshape(n, STRIDE, -1).mean(axis=1)
    columns = {"t": t} | dict(zip(arm.channels, means.T, strict=True))
    write_motion(path, columns | ({"q": q} if truth else {}))


def run(job: Job) -> Line:
    """Run one draw and judge it."""
    arm, recording = load_arm(job.arm), _recording(job.arm, job.seed)
    half = len(recording.counts) // 2
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file, sensed = folder / "file.toml", folder / "sensed.toml"
        save_arm(garbled(arm, np.random.default_rng([job.seed, 24])), file)
        write(folder / "learn.npz", arm, recording, slice(0, half), False)
        write(folder / "judge.npz", arm, recording, slice(half, None), True)
        found, took = timed(lambda: said("sensors", folder / "learn.npz", "--arm", file, "--out", sensed))
        start = ",".join(f"{angle:.6f}" for angle in recording.q[half])
        judge = folder / "judge.npz", "--arm", sensed, f"--initial-q={start}", "--out", folder / "motion.npz"
        tracked = said("track", *judge)
        learnt = load_arm(sensed)
    return judged(arm, learnt, found, tracked) | took


def judged(arm: Arm, learnt: Arm, found: Document, tracked: Document) -> Line:
    """Return what was right of a draw."""
    turns = [
        float(np.rad2deg(np.arccos(np.clip((np.trace(_axes(one).T @ _axes(other)) - 1.0) / 2.0, -1.0, 1.0))))
        for one, other in zip(arm.sensors, learnt.sensors, strict=True)
    ]
    lengths = {}
    for key, length in dict(found["lengths"]).items():
        true = getattr(arm.joints[int(key[1:]) - 1], f"{key[0]}_m")
        lengths[key] = (length["value"] - true) / length["std"]
    return {
        "converged": found["converged"],
        "axes": max(turns) < RIGHT_DEG,
        "turns_deg": turns,
        "lengths": lengths,
        "not_revealed": found["not_revealed"],
        "angle_error_deg": tracked["angle_error_deg"]["mean"],
        "within_3_std": tracked.get("within_3_std"),
        "passes": found["passes"],
    }


def _axes(sensor: Any) -> Floats:
    return rotation_from_rpy(*sensor.rotation_rad)


def said(command: str, *arguments: object) -> Document:
    """Return what a command of `fitter` says, called as from a shell, but in this process.

    Raises
    ------
    RuntimeError
        If it ends with another code than 0.
    """
    answer, words = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(answer), contextlib.redirect_stderr(words):
        code = fitter([command, *map(str, arguments), "--json"])
    if code != 0:
        raise RuntimeError(f"fitter {command} ended with {code}: {words.getvalue().strip()}")
    document: Document = json.loads(answer.getvalue())
    return document


def page(lines: Sequence[Line]) -> str:
    """Return the figures of each arm, and the draws that went wrong."""
    rows = []
    for arm in ARMS:
        own = [line for line in lines if line["arm"] == arm]
        done = [line for line in own if "error" not in line]
        z = np.array([value for line in done for value in line["lengths"].values()])
        errors = np.array([max(line["angle_error_deg"]) for line in done])
        if own:
            rows.append(
                (
                    arm,
                    len(own),
                    sum(line["converged"] for line in done),
                    sum(line["axes"] for line in done),
                    f"{np.count_nonzero(np.abs(z) < SIGMAS)} / {len(z)}",
                    *(f"{np.quantile(errors, part):.3g}" if len(errors) else "" for part in (0.5, 0.95)),
                    f"{np.median([line['seconds'] for line in done]):.0f}" if done else "",
                )
            )
    wrong = [
        (line["key"], str(line["error"]).strip().splitlines()[-1] if "error" in line else _wrong(line))
        for line in lines
        if "error" in line or not (line["converged"] and line["axes"])
    ]
    header = ("arm", "draws", "converged", "axes right", "lengths within 3σ", "worst joint [deg]", "95 %", "s")
    return "\n".join(
        [
            f"# Sensors mounted otherwise than the file says, commit {commit()}\n",
            "Made by `python -m benchmarks.mountings`. Angles are those of a motion not learnt from.\n",
            table(header, rows),
            "## What went wrong\n",
            table(("draw", "how"), wrong),
        ]
    )


def _wrong(line: Line) -> str:
    turns = ", ".join(f"{turn:.0f}" for turn in line["turns_deg"])
    errors = ", ".join(f"{error:.3g}" for error in line["angle_error_deg"])
    return f"converged {line['converged']}; axes off by {turns} deg; angles by {errors} deg"


def measure(options: argparse.Namespace) -> Document:
    """Run the draws and say what came of them."""
    jobs = [Job(ARMS[k % len(ARMS)], options.seed + k) for k in range(options.draws)]
    lines = list(run_kept("mountings", jobs, run, vars, options).values())
    return show_page("mountings", lines, page(lines), options)


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(prog="python -m benchmarks.mountings", description=__doc__, parents=[common_options()])
    add = parser.add_argument
    add("--draws", type=int, default=100, metavar="N", help="(100)")
    add("--seed", type=int, default=0)
    add_pool_options(parser)
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
