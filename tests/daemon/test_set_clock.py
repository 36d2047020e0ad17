"""The host's clock is set while samples come: no stamp moves, and the ledger says by how much it was set."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from daemon.clock.device_clock import _LATE_S
from protocol.message import GAP, HEALTH, RAW
from tests.daemon.live_run import Fields, Limbd, check, live_run, sent

RATE_HZ = 8000.0
HOUR_NS = 3600 * 10**9
WHY = "the host's clock was set"
#: The clock is set to be ahead by this many hours, one after the other; first at this sample.
SET, FIRST = (1, 0, -1), 24_000


@pytest.fixture(scope="module")
def shim(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a library that sets the clock of the processes it is loaded into, and of no others."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    built = tmp_path_factory.mktemp("clock") / "set_clock.so"
    source = Path(__file__).with_name("set_clock.c")
    strict = ["-std=gnu11", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC"]
    done = subprocess.run(
        [compiler, *strict, "-o", str(built), str(source), "-ldl"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return built


def test_a_clock_that_is_set_by_an_hour_moves_no_stamp(
    limbd: Limbd, tmp_path: Path, shim: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ahead, due, stated = tmp_path / "ahead", list(SET), list[str]()

    def set_clock(hours: int) -> None:
        with ahead.open("r+b") as file:  # in place: it is looked at all the time
            file.write((hours * HOUR_NS).to_bytes(8, "little", signed=True))

    def hear(topic: str, fields: Fields) -> None:
        if topic == GAP and fields["why"].startswith(WHY):
            stated.append(fields["why"])
        begun = topic == RAW and fields["sample0"] >= FIRST
        if due and begun and len(due) + len(stated) == len(SET):  # the one before has been stated
            set_clock(due.pop(0))

    ahead.write_bytes(bytes(8))
    monkeypatch.setenv("SET_CLOCK", str(ahead))
    monkeypatch.setenv("LD_PRELOAD", str(shim))
    heard, _ = live_run(limbd, tmp_path, "", RATE_HZ, 96_000, hear, until=lambda: len(stated) == len(SET))
    last = heard[RAW][-1]
    check(heard, sent(RATE_HZ, last["sample0"] + last["n"]))
    # A machine that is busy with other work may lose frames of the tty: that is said, and moves no stamp either.
    sets = [gap for gap in heard[GAP] if gap["why"].startswith(WHY)]
    assert [gap["why"] for gap in sets] == [
        f"the host's clock was set by {by} s" for by in ("+3600.000", "-3600.000", "-3600.000")
    ]
    assert all(gap["samples"] == 0 for gap in sets)
    stamps = np.array([block["t0_ns"] for block in heard[RAW]])
    samples = np.array([block["sample0"] for block in heard[RAW]])
    off_s = 1e-9 * np.diff(stamps) - np.diff(samples) / RATE_HZ
    assert np.median(np.abs(off_s)) < 1e-5 and np.max(np.abs(off_s)) < _LATE_S  # as late as all arrivals may be
    assert stamps[0] < sets[0]["t_ns"] < sets[1]["t_ns"] < sets[2]["t_ns"]
    assert sets[2]["t_ns"] < stamps[-1] + 10**9
    clock = heard[HEALTH][-1]["clock"]
    assert (round(clock["host_ahead_s"]), clock["host_jumps"]) == (-3600, 3)
    gaps = heard[HEALTH][-1]["gaps"]
    assert gaps["causes"][WHY] == 3
    assert [gap["why"] for gap in gaps["last"]] == [gap["why"] for gap in heard[GAP]]
    assert heard[HEALTH][-1]["lost_samples"] == sum(gap["samples"] for gap in heard[GAP])
