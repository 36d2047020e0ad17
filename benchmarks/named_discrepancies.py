"""How often `fitter diagnose` names from readings what the bench of `benchmarks.discrepancies` hides in them.

Each case is two motions to learn from and two to evaluate on, each a file whose clock begins at zero, at 100 Hz. A
late sensor and a base that shakes are in the catalogue. Play of a sensor, flex of a link and impacts are not:
there `unexplained` is right, and any name is wrong. With nothing hidden, `none` is right.

    python -m benchmarks.named_discrepancies --seeds 5

Results are those of one commit: ``benchmarks/results/named_discrepancies-<commit>.jsonl``, a line a case, and
``….md``.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from arm.arm_file import load_arm
from benchmarks.case_pool import Line, timed
from benchmarks.case_results import add_pool_options, run_kept, show_page
from benchmarks.diagnosed import by_command, said
from benchmarks.diagnosis_page import table
from benchmarks.discrepancies import EFFECTS, NOISE_M_S2, felt, swing
from benchmarks.record import commit
from fitter.data.motion_file import write_motion
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command

ARM = "dd-arm-vertical"
#: Motions to learn from, and all of them.
LEARNING, MOTIONS = 2, 4
#: What the catalogue calls what is hidden; the others it does not have.
NAMES = {"late sensor": "time_skew", "shaking base": "base_motion"}
NOTHING = "nothing"


@dataclass(frozen=True)
class Job:
    """One case; ``size`` is one of the effect's three."""

    effect: str
    size: float
    seed: int

    @property
    def key(self) -> str:
        """What the results file calls it."""
        return f"{self.effect}/{self.size:g}/{self.seed}"


def write(folder: Path, job: Job) -> list[Path]:
    """Write the readings of a case's motions, a file each."""
    arm, paths = load_arm(ARM), []
    make = EFFECTS[job.effect][0] if job.effect in EFFECTS else lambda arm, motion, _size, _rng: felt(arm, motion)
    for k in range(MOTIONS):
        rng = np.random.default_rng([job.seed, k])
        motion = swing(rng)
        readings = make(arm, motion, job.size, rng)
        readings = readings + NOISE_M_S2 * rng.standard_normal(readings.shape)
        paths.append(folder / f"{k}.npz")
        write_motion(paths[-1], {"t": motion.t} | dict(zip(arm.channels, readings.T, strict=True)))
    return paths


def run(job: Job) -> Line:
    """Diagnose one case and judge what is said."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        paths = write(folder, job)
        work = partial(by_command, paths[:LEARNING], paths[LEARNING:], Path(ARM), folder / "out")
        found, took = timed(work)
    names = sorted({cause["effect"] for cause in found["causes"]})
    expected = [NAMES[job.effect]] if job.effect in NAMES else []
    verdict = "none" if job.effect == NOTHING else "named" if expected else "unexplained"
    return {
        "said": said(found),
        "right": names == expected and found["verdict"] == verdict,
        "wrong": [name for name in names if name not in expected],
    } | took


def page(lines: Sequence[Line]) -> str:
    """Return a row for each effect and size, and what was not right."""
    rows = []
    for effect, size in dict.fromkeys((line["effect"], line["size"]) for line in lines):
        own = [line for line in lines if (line["effect"], line["size"]) == (effect, size)]
        took = sorted(line["seconds"] for line in own if "seconds" in line)
        unit = EFFECTS[effect][2] if effect in EFFECTS else ""
        right, wrong = (sum(bool(line.get(key)) for line in own) for key in ("right", "wrong"))
        failed = sum("error" in line for line in own)
        middle = f"{took[len(took) // 2]:.0f}" if took else ""
        expected = NAMES.get(effect, "none" if effect == NOTHING else "unexplained")
        rows.append((effect, f"{size:g} {unit}".strip(), expected, len(own), right, wrong, failed, middle))
    header = ("hidden", "size", "right is", "cases", "right", "wrong names", "crashed", "median s")
    missed = [
        (line["key"], str(line["said"]) if "said" in line else str(line["error"]).strip().splitlines()[-1])
        for line in lines
        if not line.get("right")
    ]
    return "\n".join(
        [
            f"# What is named of readings, commit {commit()}\n",
            "Made by `python -m benchmarks.named_discrepancies`.\n",
            table(header, rows),
            "## What was not right\n",
            table(("case", "said"), missed),
        ]
    )


def jobs(seeds: Sequence[int]) -> list[Job]:
    """Return all cases, those of one seed after those of another."""
    kinds = [(NOTHING, 0.0), *((name, size) for name, (_, sizes, _) in EFFECTS.items() for size in sizes)]
    return [Job(effect, size, seed) for seed in seeds for effect, size in kinds]


def measure(options: argparse.Namespace) -> Document:
    """Run the cases and say what came of them."""
    asked = jobs(range(options.seed, options.seed + options.seeds))
    found = run_kept("named_discrepancies", asked, run, vars, options).values()
    lines = sorted(found, key=lambda line: (line["effect"] != NOTHING, line["effect"], line["size"]))
    return show_page("named_discrepancies", lines, page(lines), options)


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(
        prog="python -m benchmarks.named_discrepancies", description=__doc__, parents=[common_options()]
    )
    add = parser.add_argument
    add("--seeds", type=int, default=5, metavar="N", help="cases of each effect and size (5)")
    add("--seed", type=int, default=0, help="the first of them (0)")
    add_pool_options(parser)
    parser.set_defaults(action=measure)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
