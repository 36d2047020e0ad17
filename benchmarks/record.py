"""Results of one commit: `benchmarks/results/<name>-<commit>.<suffix>`, never pooled over commits."""

import json
import subprocess
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

Line = dict[str, Any]

#: Where results are kept.
RESULTS = Path(__file__).parent / "results"
#: What git appends where the checkout differs from its commit.
_DIRTY = "-dirty"


@cache
def commit() -> str:
    """Return what git calls the code that runs; "unknown" where it is no checkout.

    It is asked once: what is checked out later is not what runs. Results and pages are not code.
    """
    command = ["git", "-C", str(Path(__file__).parent)]
    own = ["--", ":/", ":!/benchmarks/results", ":!/docs"]
    try:
        name, changed = (
            subprocess.run([*command, *rest], capture_output=True, text=True, check=True).stdout.strip()  # noqa: S603 - no part of it is given
            for rest in (["rev-parse", "--short", "HEAD"], ["status", "--porcelain", *own])
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return name + (_DIRTY if changed else "")


def path_of(name: str, suffix: str) -> Path:
    """Return the file of this commit's results, in a folder that is there."""
    RESULTS.mkdir(exist_ok=True)
    return RESULTS / f"{name}-{commit()}.{suffix}"


def is_exact() -> bool:
    """Say whether the commit's name says all about the code that runs."""
    return not commit().endswith(_DIRTY) and commit() != "unknown"


def read_lines(path: Path) -> list[Line]:
    """Return the lines of a results file; none where there is no file."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []


def known_lines(path: Path) -> dict[str, Line]:
    """Return the lines of this commit's earlier runs by their key; none, and no file, where code has no commit."""
    if not is_exact():
        path.unlink(missing_ok=True)
    return {line["key"]: line for line in read_lines(path)}


def append(path: Path, line: Mapping[str, Any]) -> None:
    """Add a line to a results file."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")
