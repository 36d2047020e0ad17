"""Whether tests notice a fault, tried on a small project of its own."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

pytest.importorskip("cosmic_ray", reason="the extra 'mutate' is not installed")

from benchmarks.mutation.checkout import Copy  # noqa: E402 - after the extra is looked for
from benchmarks.mutation.mutants import mutants_of, mutated  # noqa: E402
from benchmarks.mutation.trial import Runner, Trials, summary  # noqa: E402

CODE = '''"""Counting."""


def count(n):
    k = 0
    while k < n:
        k += 1
    return k


def unseen():
    return 5
'''
TESTS = "import os\n\nfrom room.counting import count\n\n\ndef test_count():\n    assert count(3) == 3\n"


@pytest.fixture(scope="module")
def runner(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runner]:
    folder = tmp_path_factory.mktemp("project")
    for name, text in {"room/counting.py": CODE, "tests/room/test_counting.py": TESTS}.items():
        (folder / name).parent.mkdir(parents=True)
        (folder / name).write_text(text)
    (folder / "benchmarks" / "mutation").mkdir(parents=True)
    own = Path(__file__).parents[3] / "benchmarks" / "mutation"
    for name in ("__init__.py", "server.py"):
        shutil.copy(own / name, folder / "benchmarks" / "mutation")
    subprocess.run(["git", "init", "--quiet", str(folder)], check=True)
    with Runner(Copy(folder, tmp_path_factory.mktemp("copy")), folder / "log.txt") as running:
        yield running


def trials(runner: Runner, notes: list[dict[str, Any]], known: dict[str, Any] | None = None) -> Trials:
    return Trials(runner, {"tests/room/test_counting.py": known} if known else {}, notes.append, 3)


def test_tests_notice_what_they_look_at(runner: Runner) -> None:
    notes: list[dict[str, Any]] = []
    some = trials(runner, notes)
    lines = [some.run(mutant) for mutant in mutants_of("room/counting.py", CODE) if mutant.line in (6, 12)]
    assert [line["outcome"] for line in lines] == ["killed", "killed", "killed", "survived", "survived"]
    assert [one["key"] for one in notes] == ["tests/room/test_counting.py"]
    assert lines[0]["by"] == "tests/room/test_counting.py::test_count" and lines[0]["mirrored"]
    said = summary(lines)
    assert "5 mutants: 3 killed, 0 timed out, 2 survived, 0 untried" in said and "60.0 % noticed" in said
    assert "room/counting.py:12  return 5 → return 6" in said


def test_a_loop_without_end_is_noticed(runner: Runner) -> None:
    endless = next(one for one in mutants_of("room/counting.py", CODE) if mutated(CODE, one).find("k += 0") > 0)
    # the tests without the fault are said to take so short that with it they must be over soon
    line = trials(runner, [], known={"code": 0, "seconds": -3.0}).run(endless)
    assert line["outcome"] == "timed out"


def test_nothing_of_a_run_that_takes_too_long_is_left(runner: Runner) -> None:
    place = runner.copy.root / "tests" / "room" / "test_slow.py"
    place.write_text(
        "import os, subprocess, time\n\n\ndef test_slow():\n"
        "    child = subprocess.Popen(['sleep', '600'], start_new_session=True)\n"
        "    open('children.txt', 'w').write(f'{child.pid} {os.getpid()}')\n    child.wait()\n"
    )
    assert runner.run("tests/room/test_slow.py", 3.0)["code"] == -1
    for pid in (runner.copy.root / "children.txt").read_text().split():
        assert not psutil.pid_exists(int(pid)) or psutil.Process(int(pid)).status() == psutil.STATUS_ZOMBIE


def test_tests_that_fail_without_a_fault_are_not_counted(runner: Runner) -> None:
    first = next(iter(mutants_of("room/counting.py", CODE)))
    assert trials(runner, [], known={"code": 1, "seconds": 0.1}).run(first)["outcome"] == "untried"
