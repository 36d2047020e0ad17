"""Motions that were made and frames that are missing, from what the daemon says."""

import pytest

from fitter.live.stream_account import StreamAccount
from protocol.message import FRAMES, HEALTH, TRIAL

DT_S, N = 0.001, 10


def frames(number, seq=None, run="a"):
    return FRAMES, {"run": run, "seq": number if seq is None else seq, "frame0": N * number, "n": N, "dt_s": DT_S}


def phase(trial, state, run="a"):
    return TRIAL, {"run": run, "trial": trial, "state": state}


def health(run="a", **fields):
    return HEALTH, {"run": run, **fields}


def account_of(*messages):
    account = StreamAccount()
    for message in messages:
        account.take(*message)
    return account


def test_a_stream_without_a_loss():
    account = account_of(*map(frames, range(5)), phase(1, "begin"), *map(frames, range(5, 9)), phase(1, "end"))
    assert (account.frames, account.made, account.lost_s, account.moving) == (90, 1, 0.0, False)
    assert account.rested_s == 0.0
    account.take(*frames(9))
    assert account.rested_s == pytest.approx(N * DT_S)
    account.take(*phase(2, "begin"))
    assert account.moving and account.made == 1 and account.rested_s == 0.0


def test_the_arm_has_not_rested_before_it_moved():
    assert account_of(*map(frames, range(100))).rested_s == 0.0


def test_what_was_sent_before_is_missing_and_so_are_its_motions():
    account = account_of(frames(30), phase(4, "begin"))
    assert account.lost_s == pytest.approx(0.3) and account.made == 3


def test_frames_in_between():
    assert account_of(frames(0), frames(5)).lost_s == pytest.approx(4 * N * DT_S)
    assert account_of(frames(0), frames(5), frames(3), frames(4)).lost_s == pytest.approx(4 * N * DT_S)


def test_what_the_device_lost_counts_once():
    """Samples lost in the device are a hole in the frames' numbers, unless they were bridged."""
    device = {"lost_samples": 1600, "device": {"rate_hz": 32000.0}}
    assert account_of(frames(0), health(**device)).lost_s == pytest.approx(0.05)
    assert account_of(frames(0), frames(5, seq=1), health(**device)).lost_s == pytest.approx(0.05)
    both = account_of(frames(0), frames(5, seq=1), frames(16, seq=7), health(**device))
    assert both.lost_s == pytest.approx(0.05 + 0.1)


def test_what_is_missing_at_the_end_is_told_by_the_heartbeat():
    last_seen = health(last_seq={FRAMES: 9, TRIAL: 5})
    account = account_of(frames(0), last_seen)
    assert account.made == 3 and account.lost_s == pytest.approx(0.09)
    account.take(*last_seen)
    assert account.lost_s == pytest.approx(0.09)
    account.take(*frames(10))
    assert account.lost_s == pytest.approx(0.09)


def test_runs_add_up():
    first = [frames(0), frames(2), phase(1, "begin"), phase(1, "end")]
    account = account_of(*first, frames(1, run="b"), phase(1, "begin", "b"), phase(1, "end", "b"))
    assert account.made == 2 and account.lost_s == pytest.approx(0.02)


@pytest.mark.parametrize(
    "message",
    [
        (FRAMES, {"run": "a", "frame0": "x", "n": 1, "dt_s": 0.1}),
        (FRAMES, {"run": "a"}),
        (TRIAL, {"run": "a", "trial": None}),
        health(last_seq=7, lost_samples="many", device=[]),
        health(last_seq={FRAMES: "x", TRIAL: None}, lost_samples=1, device={"rate_hz": 0.0}),
    ],
)
def test_what_makes_no_sense_counts_for_nothing(message):
    account = account_of(frames(0), message)
    assert (account.made, account.lost_s, account.frames) == (0, 0.0, N)
