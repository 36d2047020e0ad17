"""A bad line for long: bits that turn over, a cable that is pulled again and again."""

from pathlib import Path

from protocol.message import GAP, HEALTH
from tests.daemon.live_run import Limbd, check, live_run, sent
from tests.soak import Long

FRAME = 32


def test_no_damaged_frame_is_published_and_no_other_is_lost(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    rate_hz, seconds, share = long.of((32_000.0, 60, 1e-5), (8_000.0, 6, 1e-4))
    samples = round(seconds * rate_hz)
    heard, said = live_run(limbd, tmp_path, f"flip@0+{seconds + 60}*{share}", rate_hz, samples)
    check(heard, sent(rate_hz, samples + round(20 * rate_hz)))
    last = heard[HEALTH][-1]
    assert f"{last['crc_errors']} by flip" in said
    # The INFO and what comes after the last good frame leave no hole behind them.
    assert 0 <= last["crc_errors"] - last["lost_samples"] / FRAME <= 2 and last["lost_samples"] > 0
    assert all(gap["exact"] for gap in heard[GAP])
    long.note(
        f"bit flips at {share:g} a byte, {seconds} s at {rate_hz:g} Hz: {last['crc_errors']} damaged frames, all "
        f"counted; {last['samples']} samples published, all right; no undamaged frame lost"
    )


def test_a_cable_is_pulled_again_and_again(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    rate_hz, cycles = 8_000.0, long.of(50, 3)
    away_s, every_s = 0.3, 2.5
    samples = round((cycles * every_s + 1.0) * rate_hz)
    heard, _ = live_run(limbd, tmp_path, f"unplug@1+{away_s}/{every_s}", rate_hz, samples)
    check(heard, sent(rate_hz, samples + round(20 * rate_hz)))
    gone_s = [gap["samples"] / rate_hz for gap in heard[GAP]]
    assert {gap["why"] for gap in heard[GAP]} == {"unplugged"}
    assert len(gone_s) >= cycles and all(gap["exact"] for gap in heard[GAP])
    if long.at_length:  # how long a busy machine takes to open a line again is not the daemon's
        assert all(away_s < gap_s < away_s + 2.0 for gap_s in gone_s)
    long.note(
        f"{len(gone_s)} unplug/replug cycles: back {max(gone_s) - away_s:.2f} s after plugging in at the latest; "
        "every gap in the ledger, exact to the sample"
    )
