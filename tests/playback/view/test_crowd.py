"""Ten pages at once, and one that has stalled."""

import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import psutil

from tests.playback.view.conftest import Viewing, eventually
from tests.playback.view.crowd import Follower, stalled
from tests.soak import Long

PAGES, MEGABYTE = 10, 1e6


def test_one_that_stalls_harms_nobody(
    viewing: Callable[..., AbstractContextManager[Viewing]], motion_file: Path, long: Long
) -> None:
    pages, pictures = long.of((PAGES, 3600), (4, 60))
    with viewing(motion_file, "--arm", "dd-arm", "--twin", motion_file, "--trial", 3) as shown:
        port = int(shown.facts["url"].rpartition(":")[2])
        server = psutil.Process(shown.process.pid)
        shown.ask("loop", True)
        shown.ask("play")
        stuck = stalled(port)
        crowd = [Follower(port) for _ in range(pages)]
        try:
            eventually(lambda: all(len(one.pictures) > 30 for one in crowd), "pictures on all pages")
            begun, used = time.monotonic(), _used_s(server)
            first = [len(one.pictures) for one in crowd]
            grown = server.memory_info().rss
            eventually(
                lambda: all(len(one.pictures) > pictures for one in crowd), "many pictures on all pages", 600.0
            )
            seconds, spent = time.monotonic() - begun, _used_s(server) - used
            grown = server.memory_info().rss - grown
            rates = [(len(one.pictures) - before) / seconds for one, before in zip(crowd, first, strict=True)]
            gaps = np.concatenate(
                [np.diff(one.pictures[before:]) for one, before in zip(crowd, first, strict=True)]
            )
        finally:
            stuck.close()
            for one in crowd:
                one.close()
    assert grown < 20.0 * MEGABYTE
    worst_ms = 1e3 * np.percentile(gaps, 99)
    long.note(
        f"{pages} pages and a stalled one, {seconds:.0f} s: {min(rates):.1f} to {max(rates):.1f} pictures a s, "
        f"99 % of them within {worst_ms:.0f} ms of the one before; the page's process took "
        f"{100.0 * spent / seconds:.0f} % of a core and grew by {grown / MEGABYTE:.1f} MB"
    )


def _used_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)
