"""`limbd status`: how a running daemon is doing, from what it publishes; once, or as a live view."""

import math
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import zmq
from rich.console import Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from limbcal.command import answers, emit, say, show, strict_line
from limbcal.digits import NORMAL_95
from limbcal.errors import ConfigError, DeviceError
from protocol.curve import load_client_key
from protocol.message import HEALTH
from protocol.subscriber import Subscriber

#: Number of missed heartbeats, one a second, after which a daemon is gone.
_PATIENCE_S = 3.0
#: What no other program that publishes `limb/health` says of itself, see docs/protocol.md.
_OF_A_DAEMON = ("connected", "clock", "tracking")
#: A daemon that has just been started compiles and waits for its device before it says anything.
WAIT_S = 30.0


def status(endpoint: str, key: Path | None, once: bool, as_json: bool, wait_s: float = WAIT_S) -> None:
    """Show the daemon's health until stopped, or once.

    Parameters
    ----------
    endpoint : str
        Where the daemon publishes.
    key : Path or None
        The client's key, where the daemon asks for one.
    once, as_json : bool
        One report; one, as JSON.
    wait_s : float
        For how long to wait for a daemon that is not heard yet.

    Raises
    ------
    ConfigError
        If what is heard there is another program.
    DeviceError
        If no daemon is heard.
    """
    mine = None if key is None else load_client_key(key)
    with zmq.Context() as context, Subscriber(context, endpoint, [HEALTH], mine, watched=True) as subscriber:
        health = of_a_daemon(endpoint, _first(subscriber, endpoint, wait_s))
        if as_json:
            emit(strict_line(health))
            return
        if once:
            show(view_of(endpoint, health))
            return
        with Live(view_of(endpoint, health), console=answers(), auto_refresh=False) as live:
            while True:
                health = of_a_daemon(endpoint, _next(subscriber, endpoint))
                live.update(view_of(endpoint, health), refresh=True)


def _first(subscriber: Subscriber, endpoint: str, wait_s: float) -> Mapping[str, Any]:
    end_s, told_s = time.monotonic() + wait_s, min(_PATIENCE_S, wait_s)
    message = subscriber.receive(round(1000 * told_s))
    if message is None and wait_s > told_s:
        say(f"no daemon is heard on {endpoint} yet; waiting for {wait_s:g} s in all")
        message = subscriber.receive(max(0, round(1000 * (end_s - time.monotonic()))))
    if message is None:
        raise DeviceError(f"no daemon is heard on {endpoint} within {wait_s:g} s; is `limbd run` running there?")
    return message[1]


def _next(subscriber: Subscriber, endpoint: str) -> Mapping[str, Any]:
    message = subscriber.receive(round(1000 * _PATIENCE_S))
    if message is None:
        raise DeviceError(
            f"the daemon on {endpoint} is not heard any more since {_PATIENCE_S:g} s; was `limbd run` stopped?"
        )
    return message[1]


def of_a_daemon(endpoint: str, health: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a report that is a daemon's; those of other programs say less.

    Raises
    ------
    ConfigError
        If it is another program's.
    """
    missing = [name for name in _OF_A_DAEMON if name not in health]
    if missing:
        raise ConfigError(
            f"endpoint {endpoint}: who publishes there says nothing of {', '.join(missing)}, "
            "expected the endpoint of `limbd run`"
        )
    return health


def view_of(endpoint: str, health: Mapping[str, Any]) -> Group:
    """Return what a person sees of a report."""
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for name, text in _rows(health):
        table.add_row(Text(name, style="dim"), Text(text))
    parts: list[Any] = [Text(f"limbd, arm {health['arm']}, on {endpoint}", style="bold"), table]
    for gap in health["gaps"]["last"][-3:]:
        parts.append(
            Text(f"gap at sample {gap['sample0']}: {gap['samples']} samples, {gap['why']}", style="yellow")
        )
    for alarm in health["alarms"]:
        parts.append(
            Text(f"{alarm['name']} {alarm['subject']}: {alarm['found']}; {alarm['do']}", style="bold red")
        )
    return Group(*parts)


def _rows(health: Mapping[str, Any]) -> list[tuple[str, str]]:
    clock, latency, free = health["clock"], health["latency_ms"], health["disk_free_bytes"]
    ppm = health["clock_ppm"]
    offset = "not known yet" if ppm is None else f"{ppm:+.1f} ± {NORMAL_95 * clock['ppm_std']:.1f} ppm"
    error = "" if clock["error_ms"] is None else f", stamps to {clock['error_ms']:.2f} ms"
    where = health["recording"] or "nothing"
    return [
        ("device", "connected" if health["connected"] else "NOT CONNECTED"),
        ("up", f"{health['uptime_s']:.0f} s, {health['reconnects']} reconnects"),
        ("samples", f"{health['samples']}, {health['lost_samples']} lost"),
        ("line", f"{health['crc_errors']} checksum errors, {health['doubled']} doubled, {health['late']} late"),
        (
            "latency",
            "-" if latency["p99"] is None else f"p50 {latency['p50']:.1f} ms, p99 {latency['p99']:.1f} ms",
        ),
        ("rate", _rate(health)),
        ("clock", offset + error),
        *_joints(health["q"], health["q_units"]),
        *((f"reads {name}", _reading(mean, health["still"][name])) for name, mean in health["readings"].items()),
        ("tracking", f"{health['tracking']['method']}{', WRONG' if health['tracking']['wrong'] else ''}"),
        ("recording", where if free is None else f"{where}, {free / 1e9:.1f} GB free"),
    ]


def _rate(health: Mapping[str, Any]) -> str:
    rate = health["rate"]
    if health["rate_hz"] is None:
        return f"{rate['claimed_hz']:.7g} Hz by its INFO, not measured yet"
    half_ppm = NORMAL_95 * rate["std_ppm"]
    return f"{health['rate_hz']:.7g} Hz ± {half_ppm:.0f} ppm; {rate['claimed_hz']:.7g} Hz by its INFO"


def _joints(q: list[float | None] | None, units: list[str]) -> list[tuple[str, str]]:
    if q is None:
        return [("joints", "not known yet")]
    return [(f"joint {j}", _joint(*one)) for j, one in enumerate(zip(q, units, strict=True), start=1)]


def _joint(value: float | None, unit: str) -> str:
    if value is None:
        return "unknown"
    return f"{value:+.4f} {unit}" + (f" ({math.degrees(value):+.2f}°)" if unit == "rad" else "")


def _reading(mean: list[float] | None, still: bool) -> str:
    if mean is None:
        return "nothing came"
    axes = " ".join(f"{value:+8.3f}" for value in mean)
    return f"{axes} m/s², |a| {math.hypot(*mean):.3f}{' at rest' if still else ', it moves'}"
