"""The files of one run: a recording, and those that it went on with when it was full."""

from pathlib import Path

import pytest

from daemon.recorded_run import files_of


@pytest.mark.parametrize(
    ("there", "asked", "found"),
    [
        (["day"], "day", ["day"]),
        (["day", "day-002", "day-003"], "day", ["day", "day-002", "day-003"]),
        (["day", "day-002", "day-003"], "day-002", ["day-002", "day-003"]),
        (["day", "day-002", "day-004"], "day", ["day", "day-002"]),
        (["day", "day-001", "day-002"], "day", ["day", "day-002"]),
        (["arm-123", "arm-123-002"], "arm-123", ["arm-123", "arm-123-002"]),
        (["arm-12", "arm-12-002", "arm"], "arm-12", ["arm-12", "arm-12-002"]),
        (["arm-1234", "arm-1234-002", "arm"], "arm-1234", ["arm-1234", "arm-1234-002"]),
        (["arm-new", "arm-new-002", "arm"], "arm-new", ["arm-new", "arm-new-002"]),
        (["day", *(f"day-{k:03d}" for k in range(2, 13))], "day-009", [f"day-{k:03d}" for k in range(9, 13)]),
    ],
)
def test_those_that_follow_by_number(tmp_path: Path, there: list[str], asked: str, found: list[str]) -> None:
    for name in there:
        (tmp_path / f"{name}.mcap").touch()
    assert files_of(tmp_path / f"{asked}.mcap") == [tmp_path / f"{name}.mcap" for name in found]
