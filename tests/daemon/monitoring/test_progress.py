"""What a person at the terminal sees."""

import io
from typing import Any

from rich.console import Console

from daemon.monitoring.progress import Progress

STARTED: dict[str, Any] = {
    "device": "d [1]",
    "port": "/dev/ttyX",
    "rate_hz": 32000.0,
    "arm": "dd-arm",
    "endpoint": "tcp://127.0.0.1:5770",
    "recording": None,
}
HEALTH: dict[str, Any] = {
    "uptime_s": 7.4,
    "samples": 1000,
    "rate_hz": 31999.87,
    "lost_samples": 32,
    "crc_errors": 1,
    "latency_ms": {"p50": 1.0, "p99": 2.34},
    "recording_lost": 3,
    "tracking": {"method": "filter", "innovation": 0.5, "jolts": 0, "doubted": 0, "wrong": False},
}


def printed(terminal: bool) -> str:
    text = io.StringIO()
    with Progress(
        Console(file=text, force_terminal=terminal, width=300, color_system=None, _environ={})
    ) as progress:
        progress.started(STARTED)
        progress.health(HEALTH)
        progress.trouble("disk [/dev/x] full")
    return text.getvalue()


def test_a_line_at_the_start_and_one_at_the_end() -> None:
    first, warning, last = printed(terminal=False).splitlines()
    assert (
        first
        == "d [1] on /dev/ttyX at 32000 Hz, arm dd-arm; publishing on tcp://127.0.0.1:5770; recording nothing"
    )
    assert warning == "warning: disk [/dev/x] full"
    assert last == (
        "7 s: 1000 samples at 31999.87 Hz, 32 lost, 1 checksum errors, latency p99 2.3 ms, 3 messages not recorded"
    )


def test_a_status_on_a_terminal() -> None:
    assert "\x1b[?25l" in printed(terminal=True)  # a live line hides the cursor
    assert "\x1b" not in printed(terminal=False)


def test_a_tracker_that_is_wrong_says_so_once() -> None:
    text = io.StringIO()
    wrong = {**HEALTH, "tracking": {**HEALTH["tracking"], "wrong": True}}
    with Progress(Console(file=text, width=300, color_system=None, _environ={})) as progress:
        for fields in (HEALTH, wrong, HEALTH, wrong):
            progress.health(fields)
    warning, last = text.getvalue().splitlines()
    assert warning.startswith("warning: the readings contradict the tracker: check the lengths and the sensors'")
    assert "`fitter sensors`" in warning
    assert last.startswith("7 s: ")


def test_nothing_is_summed_up_where_nothing_began() -> None:
    text = io.StringIO()
    with Progress(Console(file=text)):
        pass
    assert text.getvalue() == ""
