"""The fuzzer at every door: briefly here, at length in ``make soak``."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.fuzz.doors import DOORS
from tests.soak import Long

#: Runs: in ``make soak``, and in ``make test``.
RUNS = {
    "frames": (1_000_000, 4_000),
    "messages": (200_000, 4_000),
    "configs": (200_000, 800),
    "recordings": (200_000, 800),
}


@pytest.mark.parametrize("door", DOORS)
def test_whatever_arrives(door: str, long: Long, tmp_path: Path) -> None:
    runs = long.of(*RUNS[door])
    # By way of a shell: a program's peak of memory, which is limited, begins with that of the one that started it.
    arguments = ["sh", "-c", '"$@" && exit', "sh", sys.executable, "-m", "tests.fuzz.fuzz", door]
    arguments += [str(tmp_path / "corpus"), str(runs)]
    ended = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout[-2000:] + ended.stderr[-4000:]
    statistics = dict(line.rsplit(":", 1) for line in ended.stderr.splitlines() if line.startswith("stat::"))
    assert int(statistics["stat::number_of_executed_units"]) >= runs
    long.note(f"{door}: {runs} runs, no crash, no hang, {statistics['stat::peak_rss_mb'].strip()} MB at most")
