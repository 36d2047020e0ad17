"""One hidden case: drawn, written, diagnosed by the command, and held against its truth."""

import contextlib
import io
import json
import os
import signal
import subprocess
import tempfile
import time
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from benchmarks.diagnosis_oracle import Known, left_by_file, left_by_oracle, read_set, true_effects
from benchmarks.diagnosis_score import payload_placed, score
from fitter.__main__ import main
from tests.diagnosis.hidden_arm import LENGTH
from tests.diagnosis.hidden_cases import Case, draw_case
from tests.diagnosis.hiding import Bench

#: How much of what the command said is kept of a case that went wrong.
_KEPT = 4000


@dataclass(frozen=True)
class Job:
    """Which case is drawn: the same job gives the same case."""

    kind: str
    seed: int
    effect: str | None
    bench: Bench = Bench()

    @property
    def key(self) -> str:
        """What a log calls it."""
        return f"{self.kind}/{self.effect}/{self.seed}"


def diagnose(learn: Path, evaluate: Path, arm: Path, out: Path) -> dict[str, Any]:
    """Call ``fitter diagnose`` as from a shell, but in this process.

    Raises
    ------
    RuntimeError
        If it ends with another code than 0: with all that it said.
    """
    answer, words = io.StringIO(), io.StringIO()
    arguments = [
        "diagnose",
        str(learn),
        "--evaluate",
        str(evaluate),
        "--arm",
        str(arm),
        "--out",
        str(out),
        "--json",
    ]
    with contextlib.redirect_stdout(answer), contextlib.redirect_stderr(words):
        code = main([*arguments, "--debug"])
    if code != 0:
        raise RuntimeError(f"fitter diagnose ended with {code}: {words.getvalue()[-_KEPT:]}")
    document: dict[str, Any] = json.loads(answer.getvalue())
    return document


def run(job: Job, limit_s: float) -> dict[str, Any]:
    """Run one case and return its line of the log; a case that crashes has an ``error`` in place of a score."""
    line: dict[str, Any] = {"key": job.key, "kind": job.kind, "seed": job.seed, "effect": job.effect}
    line["commit"] = _commit()
    try:
        with tempfile.TemporaryDirectory() as name, at_most(limit_s):
            folder = Path(name)
            case = draw_case(job.seed, job.kind, job.effect, job.bench)
            line |= {"truth": case.truth}
            learn, evaluate, arm = case.write(folder)
            begin, used_s = time.perf_counter(), _processor_s()
            found = diagnose(learn, evaluate, arm, folder / "out")
            took = {"seconds": time.perf_counter() - begin, "processor_s": _processor_s() - used_s}
            line |= took | {"found": _brief(found)}
            line["score"] = score(case.truth, found) | {"placed": payload_placed(case.truth, found)}
            if line["score"].get("right") and job.kind in ("one", "two"):
                line["score"]["beside_oracle"] = beside_oracle(
                    case, learn, evaluate, folder / "out" / "extended.toml"
                )
    except Exception:  # a benchmark of hundreds goes on: the line says what went wrong
        line["error"] = traceback.format_exc()
    return line


def beside_oracle(case: Case, learn: Path, evaluate: Path, extended: Path) -> float:
    """Return the evaluating torque error of the extended arm as a multiple of that of a model that knew all."""
    n, truth = case.arm.n_joint, case.truth
    noise = np.array(truth["torque_noise_N_m"])
    known = Known(case.hidden.links[:, LENGTH], np.array(truth["arm"]["gravity"]), noise)
    learning, evaluating = read_set(learn, n), read_set(evaluate, n)
    ideal = left_by_oracle(known, learning, evaluating, true_effects(truth)) / noise
    return float(np.sqrt(np.mean((left_by_file(known, evaluating, extended) / noise) ** 2) / np.mean(ideal**2)))


@cache
def _commit() -> str:
    """Return what git calls the code that runs; "unknown" where it is no checkout.

    Asked once: what is checked out later is not what runs.
    """
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()  # noqa: S603 - no part of it is given
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _processor_s() -> float:
    """Return the processor time [s] of this process and of those it has ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _brief(found: dict[str, Any]) -> dict[str, Any]:
    """Return what is worth keeping of a diagnosis: all but the long tail of candidates."""
    return found | {"candidates": list(found.get("candidates", []))[:8]}


@contextlib.contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Raise `TimeoutError` in the main thread when so much time has passed."""

    def late(_signum: int, _frame: FrameType | None) -> None:
        raise TimeoutError(f"not done after {seconds:g} s")

    previous = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, previous)
