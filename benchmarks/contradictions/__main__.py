"""Data that contradict themselves, given to the real commands: silent, a traceback, or right.

    python -m benchmarks.contradictions [--only KIND] [--seeds 3] [--first 0]

Every input is made here: an arm, a motion with the torque that it takes (or its tip, or its accelerations), and
one fault in it. Right is an answer that holds all the same, or a sentence that names the cause. Faultless data
must raise no question at all.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.contradictions.drawn import Case
from benchmarks.contradictions.inputs import cases


def judge(case: Case) -> str:
    """Run a case and return what it is: right, silent, wrong words, traceback."""
    with tempfile.TemporaryDirectory() as folder:
        ran = case.run(Path(folder))
    if ran.crashed:
        case.result = ran.said[-600:]
        return "traceback"
    if case.right(ran):
        return "right"
    case.result = f"exit {ran.code}: {ran.said[-700:]}"
    return "other words" if ran.code else "silent" if case.kind != "faultless" else "false alarm"


def _listed(counts: dict[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in sorted(counts.items()))


def main() -> int:
    """Score every input and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--seeds", type=int, default=3, help="motions and arms of each kind")
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("-v", action="store_true", help="say what was said where it was not right")
    arguments = parser.parse_args()
    score: dict[str, dict[str, int]] = {}
    began = time.monotonic()
    for case in cases(range(arguments.first, arguments.first + arguments.seeds)):
        if arguments.only not in case.kind:
            continue
        result = judge(case)
        score.setdefault(case.kind, {}).setdefault(result, 0)
        score[case.kind][result] += 1
        if result != "right" and arguments.v:
            sys.stderr.write(f"{case.kind} / {case.name}: {result}: {case.result}\n\n")
    total: dict[str, int] = {}
    for kind, results in score.items():
        sys.stdout.write(f"{kind:28s} {_listed(results)}\n")
        for name, count in results.items():
            total[name] = total.get(name, 0) + count
    n = sum(total.values())
    share = 100.0 * total.get("right", 0) / max(n, 1)
    sys.stdout.write(f"{n} inputs: {_listed(total)}; {share:.1f} % right, {time.monotonic() - began:.0f} s\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
