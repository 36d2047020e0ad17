"""What a person sees of a report, line by line."""

import contextlib
import io
from typing import Any

import pytest
from rich.console import Console

from daemon.monitoring import status_view
from daemon.monitoring.status_view import _first, status, view_of
from limbcal.errors import DeviceError

HEALTH: dict[str, Any] = {
    "arm": "my-arm",
    "connected": False,
    "uptime_s": 12.4,
    "reconnects": 2,
    "samples": 1000,
    "lost_samples": 32,
    "crc_errors": 3,
    "doubled": 4,
    "late": 5,
    "latency_ms": {"p50": 1.26, "p99": 9.84},
    "rate_hz": None,
    "rate": {"claimed_hz": 32000.0, "std_ppm": None},
    "clock": {"ppm_std": None, "error_ms": None},
    "clock_ppm": None,
    "readings": {"s1": [1.0, -2.0, 2.0]},
    "still": {"s1": False},
    "q": None,
    "q_units": [],
    "tracking": {"method": "integrate", "wrong": True},
    "recording": "/r/run.mcap",
    "disk_free_bytes": 2_340_000_000,
    "gaps": {"last": [{"sample0": k, "samples": 7 * k, "why": f"cause {k}"} for k in range(5)]},
    "alarms": [{"name": "flat", "subject": "s1x", "found": "it stood still", "do": "look at its cable"}],
}


class Scripted:
    """A subscriber that hears what the test scripted, and nothing before."""

    def __init__(self, *messages: tuple[str, dict[str, Any]] | None) -> None:
        self.messages = list(messages)
        self.timeouts_ms: list[int] = []

    def receive(self, timeout_ms: int) -> tuple[str, dict[str, Any]] | None:
        self.timeouts_ms.append(timeout_ms)
        return self.messages.pop(0)


def lines(**changed: Any) -> list[str]:
    text = io.StringIO()
    Console(file=text, width=200).print(view_of("tcp://h:1", {**HEALTH, **changed}))
    return [line.rstrip() for line in text.getvalue().splitlines()]


def test_all_that_is_there_is_shown() -> None:
    assert lines() == [
        "limbd, arm my-arm, on tcp://h:1",
        "device     NOT CONNECTED",
        "up         12 s, 2 reconnects",
        "samples    1000, 32 lost",
        "line       3 checksum errors, 4 doubled, 5 late",
        "latency    p50 1.3 ms, p99 9.8 ms",
        "rate       32000 Hz by its INFO, not measured yet",
        "clock      not known yet",
        "joints     not known yet",
        "reads s1     +1.000   -2.000   +2.000 m/s², |a| 3.000, it moves",
        "tracking   integrate, WRONG",
        "recording  /r/run.mcap, 2.3 GB free",
        "gap at sample 2: 14 samples, cause 2",
        "gap at sample 3: 21 samples, cause 3",
        "gap at sample 4: 28 samples, cause 4",
        "flat s1x: it stood still; look at its cable",
    ]


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({"connected": True}, "device     connected"),
        ({"latency_ms": {"p50": None, "p99": None}}, "latency    -"),
        (
            {"clock_ppm": 12.34, "clock": {"ppm_std": 0.56, "error_ms": 0.789}},
            "clock      +12.3 ± 1.1 ppm, stamps to 0.79 ms",
        ),
        ({"tracking": {"method": "filter", "wrong": False}}, "tracking   filter"),
        ({"recording": None}, "recording  nothing, 2.3 GB free"),
        ({"disk_free_bytes": None}, "recording  /r/run.mcap"),
        (
            {"rate_hz": 30720.04, "rate": {"claimed_hz": 32000.0, "in_use_hz": 30720.0, "std_ppm": 21.0}},
            "rate       30720.04 Hz ± 41 ppm; 32000 Hz by its INFO",
        ),
        ({"readings": {"s2": None}, "still": {"s2": False}}, "reads s2   nothing came"),
        ({"still": {"s1": True}}, "reads s1     +1.000   -2.000   +2.000 m/s², |a| 3.000 at rest"),
    ],
)
def test_a_line_of_the_report(changed: dict[str, Any], line: str) -> None:
    assert line in lines(**changed)


def test_joints_are_counted_from_one_in_their_own_units() -> None:
    shown = lines(q=[0.5, -0.25, None], q_units=["rad", "m", "rad"])
    assert [line for line in shown if line.startswith("joint")] == [
        "joint 1    +0.5000 rad (+28.65°)",
        "joint 2    -0.2500 m",
        "joint 3    unknown",
    ]


@pytest.mark.parametrize(("wait_s", "timeouts_ms"), [(0.5, [500]), (3.0, [3000]), (0.0, [0])])
def test_who_is_not_to_wait_for_long_is_told_once(wait_s: float, timeouts_ms: list[int]) -> None:
    subscriber = Scripted(None, None)
    with pytest.raises(DeviceError, match="no daemon is heard on ipc://x within"):
        _first(subscriber, "ipc://x", wait_s)  # type: ignore[arg-type]
    assert subscriber.timeouts_ms == timeouts_ms


def test_the_rest_of_the_wait_is_what_is_left_of_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now_s = iter([100.0, 103.5])
    monkeypatch.setattr("daemon.monitoring.status_view.time.monotonic", lambda: next(now_s))
    subscriber = Scripted(None, ("limb/health", {"samples": 1}))
    assert _first(subscriber, "ipc://x", 20.0) == {"samples": 1}  # type: ignore[arg-type]
    assert subscriber.timeouts_ms == [3000, 16_500]
    assert "waiting for 20 s in all" in capsys.readouterr().err


def test_no_time_that_is_over_is_waited(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = iter([100.0, 140.0])
    monkeypatch.setattr("daemon.monitoring.status_view.time.monotonic", lambda: next(now_s))
    subscriber = Scripted(None, None)
    with pytest.raises(DeviceError):
        _first(subscriber, "ipc://x", 20.0)  # type: ignore[arg-type]
    assert subscriber.timeouts_ms == [3000, 0]


def test_a_live_view_goes_on_until_the_daemon_falls_silent(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    subscriber = Scripted(*((status_view.HEALTH, {**HEALTH, "samples": n}) for n in (1000, 2000, 3000)), None)
    monkeypatch.setattr(status_view, "Subscriber", lambda *_, **__: contextlib.nullcontext(subscriber))
    with pytest.raises(DeviceError, match="is not heard any more since 3 s"):
        status("ipc://here", None, once=False, as_json=False)
    assert "3000, 32 lost" in capsys.readouterr().out
    assert subscriber.messages == []
