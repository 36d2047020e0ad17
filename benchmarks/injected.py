"""How often the diagnosis names what was hidden in measured recordings.

The torque that an effect would add at the measured motion is added to the torque that was measured, so truth is
known and what the model lacks is a real machine's. Effects are hidden at 40, 20 and 10 % of the torque's rms at
their joint in the recordings of two sets (`benchmarks.injection.runs`); at 0 nothing is, and each learning run is
left out in turn. `benchmarks.injection.score` says what is right and wrong. ``fitter diagnose`` diagnoses them.

Results are those of one commit: ``benchmarks/results/injected-<commit>.jsonl``, a line a case, and ``….md``. What
the file has already is not run again, unless the checkout differs from its commit: then it begins anew.
"""

import argparse
import sys
import tempfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from arm.arm_file import load_arm
from arm.model import Effect
from benchmarks.case_pool import timed
from benchmarks.case_results import add_pool_options, run_kept, show_page
from benchmarks.diagnosed import by_command, said
from benchmarks.diagnosis_page import table
from benchmarks.injection.effects import MORE, PAIRS, added_torque, drawn, rubbing_arm, sized
from benchmarks.injection.runs import ARM, SETS, read_set
from benchmarks.injection.score import score, score_nothing
from benchmarks.record import commit
from limbcal.arguments import Parser, common_options
from limbcal.command import Document, run_command
from limbcal.errors import ConfigError

Line = dict[str, Any]

#: Shares of the torque's rms [%].
SIZES = (40, 20, 10, 0)


@dataclass(frozen=True)
class Job:
    """One case; without an effect nothing is injected, and one learning run may be left out."""

    set_name: str
    effect: str | None = None
    joint: int = 0
    percent: int = 0
    seed: int = 0
    left_out: str | None = None

    @property
    def key(self) -> str:
        """What the results file calls it."""
        if self.effect is None:
            return f"{self.set_name}/nothing/{self.left_out or 'all'}"
        return f"{self.set_name}/{self.effect}/{self.joint}/{self.percent}/{self.seed}"


@cache
def injected(job: Job) -> Effect:
    """Return what is hidden in a case."""
    assert job.effect is not None
    effect = drawn(job.set_name, job.effect, job.joint, job.seed)
    return sized(effect, job.percent / 100.0, rubbing_arm(job.set_name), read_set(job.set_name))


def run(job: Job) -> Line:
    """Run one case and return its line, not yet scored."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        learn: list[Path] = []
        evaluate: list[Path] = []
        for one in read_set(job.set_name):
            if one.name == job.left_out:
                continue
            tau = one.tau
            if job.effect is not None:
                tau = tau + added_torque(rubbing_arm(job.set_name), injected(job), one)
            (learn if one.learning else evaluate).append(one.write(folder, tau))
        found, took = timed(lambda: by_command(learn, evaluate, ARM, folder / "out"))
        extended = load_arm(folder / "out" / "extended.toml")
    friction = [[joint.friction.viscous_N_m_s, joint.friction.coulomb_N_m] for joint in extended.joints]
    kept = {name: found.get(name) for name in ("verdict", "complete", "left", "causes", "confusable", "residual")}
    hidden = dict(injected(job).parameters) if job.effect is not None else None
    return {"hidden": hidden, "said": said(found), "found": kept, "friction": friction} | took


def scored(lines: dict[str, Line]) -> list[Line]:
    """Return the lines with their scores; a set's own causes are those of its lines with nothing injected."""
    done = []
    for line in lines.values():
        job = Job(**{name: line[name] for name in Job.__dataclass_fields__})
        whole = lines.get(Job(job.set_name).key, {"error": "not run"})
        if "error" in line or "error" in whole:
            done.append(line)
        elif job.effect is None:
            done.append(line | {"score": score_nothing(line, whole)} if job.left_out else line)
        else:
            own = [one for one in lines.values() if one["set_name"] == job.set_name and one["effect"] is None]
            own = [whole, *(one for one in own if one is not whole and "error" not in one)]
            arm, runs = rubbing_arm(job.set_name), read_set(job.set_name)
            done.append(line | {"score": score(line, injected(job), arm, runs, own)})
    return done


def page(lines: Sequence[Line]) -> str:
    """Return the tables: figures by size, of each pair, what was wrong, and the machines' own causes."""
    cases = [line for line in lines if line["effect"] is not None]
    parts = [
        f"# Effects injected in measured recordings, commit {commit()}\n",
        "Scoring: `benchmarks/injection/score.py`. Made by `python -m benchmarks.injected`.\n",
        figures(lines),
        "## By effect and joint: right / name / cases\n",
        by_pair(cases),
        "## What was not right\n",
        table(("case", "wrong", "said"), _wrong(cases)),
        "## Nothing injected\n",
    ]
    own = [(line["key"], _seconds([line]), _said(line)) for line in lines if line["effect"] is None]
    return "\n".join([*parts, table(("runs", "s", "said"), own)])


def figures(lines: Sequence[Line]) -> str:
    """Return a row for each size and set of effects."""
    rows = []
    for title, pairs in (("22 pairs", PAIRS), ("further", MORE)):
        for percent in SIZES[:-1]:
            own = [
                line for line in lines if line["percent"] == percent and (line["effect"], line["joint"]) in pairs
            ]
            if own:
                rows.append((title, f"{percent} %", len(own), *_counts(own), _seconds(own)))
    left_out = [line for line in lines if line["left_out"]]
    if left_out:
        wrong = sum(bool(line.get("score", {}).get("wrong")) for line in left_out)
        rows.append(
            ("nothing", "0", len(left_out), "", "", "", "", f"{wrong}", _errors(left_out), _seconds(left_out))
        )
    header = ("effects", "size", "cases", "right", "%", "name", "size holds", "wrong names", "crashed", "median s")
    return table(header, rows)


def _counts(lines: Sequence[Line]) -> tuple[object, ...]:
    scores = [line.get("score", {}) for line in lines]
    right = sum(bool(one.get("right")) for one in scores)
    asked = [one for one in scores if one.get("size") is not None]
    holds = f"{sum(one['size'] for one in asked)} / {len(asked)}"
    named, wrong = (sum(bool(one.get(key)) for one in scores) for key in ("name", "wrong"))
    return right, f"{100.0 * right / len(lines):.0f}", named, holds, wrong, _errors(lines)


def _errors(lines: Sequence[Line]) -> int:
    return sum("error" in line for line in lines)


def _seconds(lines: Sequence[Line]) -> str:
    took = sorted(line["seconds"] for line in lines if "seconds" in line)
    return f"{took[len(took) // 2]:.0f}" if took else ""


def by_pair(lines: Sequence[Line]) -> str:
    """Return a row for each effect and joint."""
    rows = []
    for name, joint in (*PAIRS, *MORE):
        cells: list[str] = []
        for percent in SIZES[:-1]:
            own = [
                line
                for line in lines
                if (line["effect"], line["joint"], line["percent"]) == (name, joint, percent)
            ]
            scores = [line.get("score", {}) for line in own]
            right, named = (sum(bool(one.get(key)) for one in scores) for key in ("right", "name"))
            cells.append(f"{right} / {named} / {len(own)}" if own else "")
        if any(cells):
            rows.append((name, joint or "", *cells))
    return table(("effect", "joint", *(f"{percent} %" for percent in SIZES[:-1])), rows)


def _wrong(lines: Sequence[Line]) -> list[tuple[str, str, str]]:
    rows = []
    for line in lines:
        one = line.get("score", {})
        if one.get("right") and not one["wrong"]:
            continue
        parts = [] if one.get("name") else ["no name" if "error" not in line else "crashed"]
        if one.get("size") is False:
            parts.append(f"size {one['ratio']:.2f} ± {one['std']:.2g}")
        parts += [f"wrong name {effect} {','.join(map(str, joints))}" for effect, joints in one.get("wrong", ())]
        rows.append((line["key"], "; ".join(parts), _said(line)))
    return rows


def _said(line: Line) -> str:
    return str(line["said"]) if "said" in line else str(line.get("error", "")).strip().splitlines()[-1]


def jobs(options: argparse.Namespace) -> list[Job]:
    """Return the cases that are asked for; those with nothing injected come first."""
    sizes = [percent for percent in options.sizes if percent]
    todo = [Job(name) for name in options.sets]
    if 0 in options.sizes:
        todo += [Job(name, left_out=one.name) for name in options.sets for one in read_set(name) if one.learning]
    pairs = [pair for pair in (*PAIRS, *(MORE if options.more else ())) if pair[0] in options.effects]
    every = [
        Job(name, pair[0], pair[1], size, options.seed)
        for size in sizes
        for pair in pairs
        for name in options.sets
    ]
    mixed = sorted(every, key=lambda job: zlib.crc32(job.key.encode()))  # a part has some of all sets and joints
    return [*todo, *mixed[:: options.every]]


def measure(options: argparse.Namespace) -> Document:
    """Run the cases, score them all, and say what came of them."""
    done = scored(run_kept("injected", jobs(options), run, vars, options))
    return show_page("injected", done, page(done), options)


def _listed(text: str) -> list[str]:
    return text.split(",")


def _sizes(text: str) -> list[int]:
    return [int(part) for part in text.split(",")]


def act(options: argparse.Namespace) -> Document:
    """Check what was asked for, and do it."""
    effects = sorted({name for name, _ in (*PAIRS, *MORE)})
    options.effects = options.effects or effects
    for option, given, known in (
        ("--sets", options.sets, list(SETS)),
        ("--sizes", options.sizes, list(SIZES)),
        ("--effects", options.effects, effects),
    ):
        if unknown := [str(one) for one in given if one not in known]:
            raise ConfigError(f"{option} has {', '.join(unknown)}; expected some of {', '.join(map(str, known))}")
    return measure(options)


def main(argv: list[str] | None = None) -> int:
    """Run the benchmark and return its exit code."""
    parser = Parser(prog="python -m benchmarks.injected", description=__doc__, parents=[common_options()])
    add = parser.add_argument
    add("--sets", type=_listed, default=list(SETS), metavar="SET[,SET]", help=f"of {', '.join(SETS)}")
    add("--sizes", type=_sizes, default=list(SIZES), metavar="P[,P…]", help="percent of the torque's rms")
    add("--effects", type=_listed, metavar="E[,E…]", help="only these")
    add("--more", action="store_true", help="effects beyond the 22 pairs as well")
    add("--every", type=int, default=1, metavar="N", help="only every N-th case")
    add("--seed", type=int, default=0)
    add_pool_options(parser)
    parser.set_defaults(action=act)
    return run_command(parser, argv)


if __name__ == "__main__":
    sys.exit(main())
