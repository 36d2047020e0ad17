"""What goes wrong on a real tty: nothing wrong is published, and every missing sample is in the ledger."""

from pathlib import Path

import numpy as np
import pytest

from arm.counts import COUNT_M_S2
from protocol.message import GAP, HEALTH, RAW
from tests.daemon.live_run import Limbd, check, live_run, sent

RATE_HZ = 8000.0
SCHEDULE = (
    "unplug@0.5+0.42, unplug@5.75+0.42/20, garbage@1.4+0.4*20000, silent@2.2+0.5, baud@3.2+0.4, flip@4.2+1.5*1e-4,"
    "double@6.2+1.7*0.05, reorder@6.2+1.7*0.05, drop@6.2+1.7*0.02, stranger@8+0.8"
)


@pytest.fixture(scope="module")
def truth() -> np.ndarray:
    return sent(RATE_HZ, 200_000)


def test_what_is_published_is_right_and_what_is_missing_is_told(
    limbd: Limbd, tmp_path: Path, truth: np.ndarray
) -> None:
    heard, said = live_run(limbd, tmp_path, SCHEDULE, RATE_HZ, 80_000)
    check(heard, truth)
    assert {gap["why"] for gap in heard[GAP]} == {
        *("unplugged", "the device was silent", "damaged on the line", "frames missing")
    }
    assert all(gap["exact"] for gap in heard[GAP])
    last = heard[HEALTH][-1]
    assert f"{last['crc_errors']} by flip" in said
    assert last["reconnects"] == 4  # the stranger was plugged in, too
    assert last["strangers"] > 0
    assert last["doubled"] > 0 and last["late"] == 0
    unplugged = [gap["samples"] / RATE_HZ for gap in heard[GAP] if gap["why"] == "unplugged"]
    assert 0.4 < unplugged[-1] < 2.4  # back within two seconds; the first may have come before START


def test_a_device_that_was_away_for_long_is_taken_up_before_it_must_forget(
    limbd: Limbd, tmp_path: Path, truth: np.ndarray
) -> None:
    """It holds less than a second of samples, which is how seldom a port that stays away is tried in the end."""
    heard, said = live_run(limbd, tmp_path, "unplug@1+2.65", RATE_HZ, 48_000)
    check(heard, truth)
    assert [gap["why"] for gap in heard[GAP]] == ["unplugged"]
    assert "frames are dropped" not in said


def test_a_silent_device_is_started_again_and_its_answers_are_no_samples(
    limbd: Limbd, tmp_path: Path, truth: np.ndarray
) -> None:
    """It hears every command, numbers the answer and does not send it."""
    heard, _ = live_run(limbd, tmp_path, "silent@1+2.1", RATE_HZ, 32_000)
    check(heard, truth)
    assert [(gap["why"], gap["exact"]) for gap in heard[GAP]] == [("the device was silent", True)]


def test_a_device_that_lost_its_power_is_started_again(limbd: Limbd, tmp_path: Path, truth: np.ndarray) -> None:
    heard, _ = live_run(limbd, tmp_path, "restart@3+0.5", RATE_HZ, 40_000)
    (gap,) = heard[GAP]
    assert (gap["why"], gap["exact"]) == ("the device was restarted", False)
    after = next(block for block in heard[RAW] if block["sample0"] > gap["sample0"])
    at = after["sample0"]
    counts = np.rint(after["a"] / COUNT_M_S2)
    shifts = [s for s in range(-2400, 2401) if np.array_equal(truth[at + s : at + s + len(counts)], counts)]
    assert len(shifts) == 1  # as far off as the host is unsure of when it heard the device, in samples
