"""One fault and its tests: whether they notice it."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Self

from benchmarks.mutation.checkout import Copy
from benchmarks.mutation.mirror import mirrored, tests_of
from benchmarks.mutation.mutants import Mutant, change, mutated
from benchmarks.mutation.server import TOO_LONG

Line = dict[str, Any]

#: What a test file may take with a fault: this many times what it takes without, and some seconds: processors are
#: shared, and a short run is mostly a matter of what else they do.
LIMIT_FACTOR, LIMIT_MORE_S = 4.0, 15.0
#: What the test file of the module's name, and any other, may take without a fault: one that takes longer is too
#: slow to be run for each fault.
SLOWEST_OWN_S, SLOWEST_S = 60.0, 15.0
#: What may become of a fault; where no test file was fast enough to be run, it is not known.
UNNOTICED = ("survived", "untried")
OUTCOMES = ("killed", "timed out", *UNNOTICED)
_FIRST_FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+)", re.MULTILINE)


class Runner(AbstractContextManager["Runner"]):
    """Runs the test files of a copy of the checkout.

    Parameters
    ----------
    copy : Copy
    log : Path
        What the last run said; outside of the copy.
    """

    def __init__(self, copy: Copy, log: Path) -> None:
        self.copy, self._log = copy, log
        self._process: subprocess.Popen[str] | None = None

    def __enter__(self) -> Self:
        """Start the process that runs tests."""
        environment = {
            **os.environ,
            "PYTHONPATH": str(self.copy.root),
            "PYTHONDONTWRITEBYTECODE": "1",
            **dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
        }
        self._process = subprocess.Popen(  # noqa: S603 - our own module
            [sys.executable, "-m", "benchmarks.mutation.server"],
            **{"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True},
            cwd=self.copy.root,
            env=environment,
        )
        self._read()
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        assert self._process is not None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def run(self, file: str, limit_s: float) -> Line:
        """Run a test file, up to the first test that fails; return its exit code, time and that test."""
        # Libraries are there before pytest looks at what they assert; nobody asks what that is.
        loaded = ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
        arguments = ["-x", "-q", "--tb=no", "-p", "no:cacheprovider", *loaded, file]
        request = {"arguments": arguments, "log": str(self._log), "limit_s": limit_s}
        assert self._process is not None
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        answer = self._read()
        failed = _FIRST_FAILED.search(self._log.read_text(encoding="utf-8", errors="replace"))
        return answer | {"failed": failed and failed[1]}

    def _read(self) -> Line:
        assert self._process is not None
        assert self._process.stdout is not None
        answer: Line = json.loads(self._process.stdout.readline())
        return answer


class Trials:
    """Puts faults into the copy and runs the tests that should notice.

    Parameters
    ----------
    runner : Runner
    known : mapping
        What is known of test files without a fault, by their name.
    note : callable
        Is given each line that becomes known of them.
    most : int
        How many test files a fault has to be noticed by one of.
    patience : float
        How many times as long all may take, where others have the processors busy.
    """

    def __init__(
        self,
        runner: Runner,
        known: dict[str, Line],
        note: Callable[[Line], None],
        most: int,
        patience: float = 1.0,
    ) -> None:
        self._runner, self._known, self._note, self._most = runner, known, note, most
        self._patience = patience

    def run(self, mutant: Mutant) -> Line:
        """Try one fault; the line says what noticed it."""
        root = self._runner.copy.root
        code = (root / mutant.path).read_text(encoding="utf-8")
        changed = mutated(code, mutant)
        own = mirrored(root, mutant.path)
        line: Line = {"key": mutant.key, "path": mutant.path, "line": mutant.line, "change": change(code, changed)}
        tried = []
        for file in tests_of(root, mutant.path, self._most):
            if not self._usable(file, SLOWEST_OWN_S if file == own else SLOWEST_S):
                continue
            tried.append(file)
            with self._runner.copy.having(mutant.path, changed):
                limit_s = LIMIT_FACTOR * self._known[file]["seconds"] + self._patience * LIMIT_MORE_S
                found = self._runner.run(file, limit_s)
            if found["code"]:
                outcome = "timed out" if found["code"] == TOO_LONG else "killed"
                return line | {"outcome": outcome, "by": found["failed"] or file, "mirrored": file == own}
        return line | {"outcome": "survived" if tried else "untried", "tried": tried}

    def _usable(self, file: str, slowest_s: float) -> bool:
        """Say whether a test file passes without a fault, and soon enough."""
        if file not in self._known:
            self._known[file] = {"key": file, **self._runner.run(file, self._patience * slowest_s)}
            self._note(self._known[file])
        return not self._known[file]["code"]


def summary(lines: Sequence[Line]) -> str:
    """Return what became of the faults, and those that nobody noticed."""
    counts = {name: sum(line["outcome"] == name for line in lines) for name in OUTCOMES}
    noticed = counts["killed"] + counts["timed out"]
    own = sum(bool(line.get("mirrored")) for line in lines)
    share = 100.0 * noticed / len(lines) if lines else 0.0
    said = {
        name: [f"{line['path']}:{line['line']}  {line['change']}" for line in lines if line["outcome"] == name]
        for name in UNNOTICED
    }
    return "\n".join(
        [
            f"{len(lines)} mutants: " + ", ".join(f"{count} {name}" for name, count in counts.items()),
            f"{share:.1f} % noticed; {own} by the test file of the module's name",
            *(text for name, ones in said.items() if ones for text in (f"{name}:", *sorted(ones))),
        ]
    )
