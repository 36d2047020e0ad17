"""A device whose clock lies once a minute, at random: no stamp believes it for long, and each lie is reported."""

import time
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
import zmq

from arm.model import Floats
from protocol.message import GAP, HEALTH, RAW
from protocol.subscriber import Subscriber
from tests.daemon.live_run import Limbd
from tests.patience import PATIENCE_MS
from tests.soak import Long
from tests.soak.lying_device import FRAME, TICK_HZ, Lie, LyingDevice, lies_of, number_of

MEGABYTE = 1e6
#: What a frame's way may take beyond the shortest: a reader's batch and two waits of a busy host [s].
_WAY_S = 0.02
#: A lie is recognised within so long [s].
_RECOGNISED_S = 1.0
_SUDDEN = ("jump", "torn", "to zero", "halt")
_GRADUAL = ("clock drifts", "oscillator drifts")


@dataclass
class Found:
    """What a subscriber saw: of each block's first sample its number, the one it carries, and its stamp [s]."""

    reported: list[int] = field(default_factory=list)
    number: list[int] = field(default_factory=list)
    stamp_s: list[float] = field(default_factory=list)
    gaps: list[dict[str, Any]] = field(default_factory=list)
    health: list[dict[str, Any]] = field(default_factory=list)
    held_mb: list[list[float]] = field(default_factory=list)


def followed(limbd: Limbd, folder: Path, device: LyingDevice, seconds: float) -> Found:
    """Let the daemon stream for so long, and return what came."""
    utc_s = time.time() - time.monotonic()
    endpoint, config, found = f"ipc://{folder}/frames", folder / "limbd.toml", Found()
    config.write_text(
        f'[device]\nport = "{device.path}"\n[arm]\nfile = "dd-arm"\n[tracking]\nmethod = "integrate"\n'
        f'[publish]\nendpoint = "{endpoint}"\nraw = true\n'
    )
    with zmq.Context() as context, Subscriber(context, endpoint, [RAW, GAP, HEALTH]) as subscriber:
        daemon = limbd("run", "--config", str(config), "--json")
        processes = [psutil.Process(pid) for pid in daemon.announcement()["processes"].values()]
        while not found.health or found.health[-1]["uptime_s"] < seconds:
            topic, fields = subscriber.receive(PATIENCE_MS) or pytest.fail("nothing came any more")
            assert device.failed is None
            if topic == RAW:
                found.reported.append(fields["sample0"])
                found.number.append(number_of(fields["a"][0]))
                found.stamp_s.append(1e-9 * fields["t0_ns"] - utc_s)
            elif topic == GAP:
                found.gaps.append(fields)
            else:
                found.health.append(fields)
                found.held_mb.append([own_mb(process) for process in processes])
        assert not subscriber.missed
    assert daemon.stop() == 0
    return found


def own_mb(process: psutil.Process) -> float:
    """Return what a process holds that is no file's: who else has its libraries open is nothing of its own."""
    memory = process.memory_info()
    return float(memory.rss - memory.shared) / MEGABYTE


def settled(true_s: Floats, lies: list[Lie], device: LyingDevice) -> Any:
    """Say which samples were taken when no lie had begun or ended for as long as it takes to recognise it."""
    turns = [frame for lie in lies for frame in (lie.frame, lie.over) if frame is not None]
    recent = np.zeros(len(true_s), dtype=bool)
    for turn_s in (device.taken[frame][0] for frame in turns):
        recent |= (true_s >= turn_s) & (true_s <= turn_s + _RECOGNISED_S)
    return ~recent


def stated_s(found: Found) -> Floats:
    """Return the largest stated error of the stamps about each block, NaN before the first."""
    reached = [health["samples"] + health["lost_samples"] for health in found.health]
    error_ms = np.array([health["clock"]["error_ms"] or np.nan for health in found.health])
    k = np.searchsorted(reached, found.reported)
    last = len(reached) - 1
    return np.asarray(1e-3 * np.maximum(error_ms[np.clip(k - 1, 0, last)], error_ms[np.clip(k, 0, last)]))


def reported(lie: Lie, found: Found, device: LyingDevice) -> bool:
    """Say whether a lie is in the ledger, or an alarm tells of it, or the stated error of one that is slow."""
    assert lie.frame is not None
    off = dict(zip(found.reported, np.array(found.number) - found.reported, strict=True))
    numbers = np.array(found.reported)
    for gap in found.gaps:
        before = numbers[max(int(np.searchsorted(numbers, gap["sample0"])) - 1, 0)]
        frame = (gap["sample0"] + off[before]) / FRAME
        if not gap["exact"] and lie.frame <= frame <= (lie.over or lie.frame) + 8:
            return True
    if lie.kind in _SUDDEN:
        return False
    first, last = lie.frame * FRAME, (lie.over or lie.frame) * FRAME + 10 * device.rate_hz
    of_it = [health for health in found.health if first <= health["samples"] <= last]
    if any(alarm["name"] in ("rate", "clock") for health in of_it for alarm in health["alarms"]):
        return True
    moved_ms = 1e3 * abs(lie.by) * lie.lasts_s  # what arrivals may wait for is reported by the stated error alone
    return any(3.0 * (health["clock"]["error_ms"] or 0.0) >= moved_ms for health in of_it)


def test_a_clock_that_lies_once_a_minute_moves_no_stamp_and_is_told(
    limbd: Limbd, tmp_path: Path, long: Long
) -> None:
    for bits in long.of((64, 32), (32,)):
        seconds = long.of(30.0 * long.minutes, 6.5)
        every_s, kinds = long.of((60.0, (*_SUDDEN, *_GRADUAL)), (1.5, _SUDDEN))
        lies = lies_of(bits, bits, kinds, every_s, seconds - 0.5 * every_s)
        folder = tmp_path / str(bits)
        folder.mkdir()
        with closing(LyingDevice(8_000.0, lies, bits, (1 << 32) - round(3.0 * TICK_HZ))) as device:
            found = followed(limbd, folder, device, seconds)
        judge(found, device, seconds, long)


def judge(found: Found, device: LyingDevice, seconds: float, long: Long) -> None:
    lied = [lie for lie in device.lies if lie.frame is not None and lie.over is not None]
    assert len(lied) >= len(device.lies) - 1
    numbers, stamps_s = np.array(found.number), np.array(found.stamp_s)
    true_s = np.array([device.true_s(number) for number in found.number])
    error_s, off_s = stated_s(found), np.abs(stamps_s - true_s)
    known = settled(true_s, lied, device) & np.isfinite(error_s)
    beyond = known & (off_s > 3.0 * error_s + _WAY_S)
    untold = [lie.text for lie in lied if not reported(lie, found, device)]
    miscounted = np.flatnonzero(np.diff(numbers - found.reported))
    grown_mb = held(found, seconds)
    long.note(
        f"{seconds / 60:.1f} min, a counter of {device.bits} bits, {len(lied)} lies, {len(untold)} not reported: "
        f"{np.count_nonzero(beyond)} of {np.count_nonzero(known)} stamps wrong a second after a lie, the farthest "
        f"{1e3 * off_s[known].max(initial=0.0):.0f} ms off; {len(miscounted)} gaps of samples that never were, "
        f"none called exact; all processes together grow by {grown_mb:.2f} MB"
    )
    assert np.all(np.diff(stamps_s) > 0.0)
    assert not np.any(beyond), [(true_s[k] - true_s[0], off_s[k], error_s[k]) for k in np.flatnonzero(beyond)][:20]
    assert not untold
    assert all(not gap["exact"] for gap in found.gaps)  # none was lost, so no number says so
    if long.at_length:
        assert grown_mb < 5.0


def held(found: Found, seconds: float) -> float:
    """Return by how much the daemon's memory grows in the whole time, by the trend of the last two thirds [MB]."""
    rows = np.array([[one["uptime_s"], sum(mb)] for one, mb in zip(found.health, found.held_mb, strict=True)])
    rows = rows[len(rows) // 3 :]
    return float(np.polyfit(rows[:, 0], rows[:, 1], 1)[0] * seconds)
