"""Beside others that keep the processors busy, faster than it must be, and for long."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import zmq

from daemon.virtual_device.virtual_device import FRAME_SAMPLES
from protocol.message import HEALTH
from protocol.subscriber import Subscriber
from tests.daemon.live_run import Fields, Limbd, dropped
from tests.patience import PATIENCE_MS
from tests.soak import Long

MEGABYTE = 1e6


@contextmanager
def busy_processors() -> Iterator[None]:
    """Keep every processor busy."""
    with ExitStack() as stack:
        for _ in range(os.cpu_count() or 1):
            burner = stack.enter_context(subprocess.Popen([sys.executable, "-c", "while True: pass"]))
            stack.callback(burner.kill)
        yield


def watch(
    limbd: Limbd,
    folder: Path,
    seconds: float,
    device: tuple[str, ...],
    config: str = "",
    at_end: Callable[[str], None] = lambda _said: None,
) -> Iterator[Any]:
    """Run device and daemon; yield the announcement, then each health; stop both, pass on what the device said."""
    link, endpoint = folder / "device", f"ipc://{folder}/frames"
    virtual = limbd("virtual", "--link", str(link), *device, "--json")
    virtual.announcement()
    file = folder / "limbd.toml"
    file.write_text(
        f'[device]\nport = "{link}"\n[arm]\nfile = "dd-arm"\n[tracking]\nmethod = "integrate"\n'
        f'[publish]\nendpoint = "{endpoint}"\n[record]\ndirectory = "{folder}/rec"\n{config}'
    )
    with zmq.Context() as context, Subscriber(context, endpoint, [HEALTH]) as subscriber:
        daemon = limbd("run", "--config", str(file), "--json")
        yield daemon.announcement()
        uptime_s = 0.0
        while uptime_s < seconds:
            message = subscriber.receive(PATIENCE_MS)
            assert message is not None
            uptime_s = message[1]["uptime_s"]
            yield message[1]
    assert daemon.stop() == 0
    assert virtual.stop() == 0
    at_end(virtual.said)


def check_losses(health: Fields, said: str, long: Long) -> None:
    """On a machine of its own the daemon loses nothing; on any, nothing but what the device had to drop."""
    assert health["lost_samples"] <= FRAME_SAMPLES * dropped(said)
    assert not (long.at_length and dropped(said))


def test_beside_busy_processors_nothing_is_lost(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    (seconds, rate_hz), said = long.of((600.0, 32_000), (4.0, 8_000)), list[str]()
    device = ("--rate-hz", str(rate_hz), "--trials", "200")
    following = watch(limbd, tmp_path, seconds, device, at_end=said.append)
    next(following)
    with busy_processors():  # from here on: how fast all comes up beside busy processors is not the daemon's
        *_, last = following
    assert last["samples"] > 0
    check_losses(last, *said, long)
    p99_ms = last["latency_ms"]["p99_run"]
    long.note(
        f"{seconds:g} s at {rate_hz} Hz beside busy processors: {last['lost_samples']} samples lost; "
        f"latency p99 {p99_ms:.1f} ms"
    )
    if long.at_length:
        assert last["samples"] > 0.9 * seconds * rate_hz
        assert p99_ms < 25.0


def test_it_keeps_up_with_eight_times_the_rate(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    (seconds, speed), said = long.of((30.0, 8), (4.0, 1)), list[str]()
    _, *health = watch(limbd, tmp_path, seconds, ("--speed", str(speed)), at_end=said.append)
    last = health[-1]
    rate_hz = (last["samples"] - health[1]["samples"]) / (last["uptime_s"] - health[1]["uptime_s"])
    check_losses(last, *said, long)
    if long.at_length:
        assert rate_hz > 0.97 * speed * 32_000
    long.note(
        f"{speed} x 32 kHz through the real path for {seconds:g} s: {rate_hz / 32_000:.2f} x 32 kHz held, "
        f"{last['lost_samples']} samples lost, latency p99 {last['latency_ms']['p99_run']:.0f} ms"
    )


def _shared(processes: list[psutil.Process]) -> set[str]:
    """Return the shared memory that processes have in use: other programs have their own."""
    maps = (one.path for process in processes for one in process.memory_maps())
    return {path for path in maps if path.startswith("/dev/shm/") and not path.endswith("(deleted)")}


def test_nothing_grows(limbd: Limbd, tmp_path: Path, long: Long) -> None:
    seconds = long.of(1800.0, 10.0)
    faults = "unplug@7+0.5/60, flip@0+1e6*1e-6, drop@20+2*0.01/45"
    following = watch(
        limbd,
        tmp_path,
        seconds,
        ("--rate-hz", str(long.of(32_000, 8_000)), "--trials", "1000", "--fault", faults),
        f"file_minutes = {long.of(5.0, 0.1)}\n",
    )
    processes = [psutil.Process(pid) for pid in next(following)["processes"].values()]
    rows, shared = [], set[str]()
    for health in following:
        shared |= _shared(processes)
        held = [p.memory_full_info().uss / MEGABYTE for p in processes]
        rows.append([health["uptime_s"], sum(p.num_fds() for p in processes), *held])
    settled = np.array(rows)[len(rows) // 3 :]
    # A file's index grows until it is closed, so what counts is the trend over whole files, not two instants.
    trends = np.polyfit(settled[:, 0], settled[:, 2:], 1)[0] * seconds
    grown_mb, handles = float(trends.sum()), int(settled[-1, 1] - settled[0, 1])
    assert handles < 3  # a port that is unplugged just then, a file that is being changed; a leak is more
    assert shared
    assert not [path for path in shared if Path(path).exists()]
    if long.at_length:
        assert grown_mb < 5.0, trends
    files = len(list((tmp_path / "rec").iterdir()))
    long.note(
        f"{seconds / 60:.1f} min with faults and {files} files: by the trend of the last two thirds all processes "
        f"together grow by {grown_mb:.2f} MB in that time ({', '.join(f'{trend:.2f}' for trend in trends)}), "
        f"{handles:+d} handles"
    )
