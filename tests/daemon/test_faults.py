"""What goes wrong on a real tty: nothing wrong is published, and every missing sample is in the ledger."""

from pathlib import Path

import numpy as np

from arm.counts import COUNT_M_S2
from protocol.message import GAP, HEALTH, RAW
from tests.daemon.live_run import Fields, Heard, Limbd, check, live_run, sent

RATE_HZ = 8000.0
#: The device holds less than a second of samples; a cable is away for longer, and so is its voice.
SCHEDULE = (
    "unplug@0.5+0.42, unplug@7.35+0.42/20, garbage@1.4+0.4*20000, silent@2.2+2.1, baud@4.8+0.4,"
    "flip@5.8+1.5*1e-4, double@7.8+1.7*0.05, reorder@7.8+1.7*0.05, drop@7.8+1.7*0.02, stranger@9.6+0.8,"
    "unplug@12+2.65, restart@16+0.5"
)
SAMPLES = 144_000


def test_what_is_published_is_right_and_what_is_missing_is_told(limbd: Limbd, tmp_path: Path) -> None:
    heard, said = live_run(limbd, tmp_path, SCHEDULE, RATE_HZ, SAMPLES)
    truth, gaps = sent(RATE_HZ, 200_000), heard[GAP]
    (restart,) = (gap for gap in gaps if gap["why"] == "the device was restarted")
    check(heard, truth, until=restart["sample0"])
    assert {gap["why"] for gap in gaps} == {
        *(
            "unplugged",
            "the device was silent",
            "damaged on the line",
            "frames missing",
            "the device was restarted",
        )
    }
    assert [gap for gap in gaps if not gap["exact"]] == [restart]
    assert len([gap for gap in gaps if gap["why"] == "the device was silent"]) == 1  # its answers are no samples
    last = heard[HEALTH][-1]
    assert f"{last['crc_errors']} by flip" in said
    assert last["reconnects"] == 5  # the stranger was plugged in, too
    assert last["strangers"] > 0
    assert last["doubled"] > 0 and last["late"] == 0
    *_, short, long = (gap["samples"] / RATE_HZ for gap in gaps if gap["why"] == "unplugged")
    assert 0.4 < short < 2.4  # back within two seconds; the first may have come before START
    assert 2.6 < long and "frames are dropped" not in said  # taken up before the device must forget
    started_again(heard, restart, truth)


def started_again(heard: Heard, gap: Fields, truth: np.ndarray) -> None:
    """Hold what came after the restart against the truth, off by what the host does not know of the pause."""
    after = next(block for block in heard[RAW] if block["sample0"] > gap["sample0"])
    at, counts = after["sample0"], np.rint(after["a"] / COUNT_M_S2)
    shifts = [s for s in range(-2400, 2401) if np.array_equal(truth[at + s : at + s + len(counts)], counts)]
    assert len(shifts) == 1
