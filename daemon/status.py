"""`limbd status`: how a running daemon is doing, from what it publishes; once, or as a live view."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import zmq
from rich.console import Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from limbcal.command import answers, emit, show
from limbcal.errors import DeviceError
from protocol.curve import load_client_key
from protocol.message import HEALTH
from protocol.subscriber import Subscriber

#: The heartbeat comes once a second.
_PATIENCE_S = 3.0


def status(endpoint: str, key: Path | None, once: bool, as_json: bool) -> None:
    """Show the daemon's health until stopped, or once.

    Parameters
    ----------
    endpoint : str
        Where the daemon publishes.
    key : Path or None
        The client's key, where the daemon asks for one.
    once, as_json : bool
        One report, and as JSON; live JSON is a line a report.

    Raises
    ------
    DeviceError
        If no daemon is heard.
    """
    mine = None if key is None else load_client_key(key)
    with zmq.Context() as context, Subscriber(context, endpoint, [HEALTH], mine) as subscriber:
        health = _next(subscriber, endpoint)
        if as_json or once:
            while True:
                emit(json.dumps(health)) if as_json else show(_view(endpoint, health))
                if once:
                    return
                health = _next(subscriber, endpoint)
        with Live(_view(endpoint, health), console=answers(), auto_refresh=False) as live:
            while True:
                live.update(_view(endpoint, _next(subscriber, endpoint)), refresh=True)


def _next(subscriber: Subscriber, endpoint: str) -> Mapping[str, Any]:
    message = subscriber.receive(round(1000 * _PATIENCE_S))
    if message is None:
        raise DeviceError(
            f"no daemon is heard on {endpoint} within {_PATIENCE_S:g} s; is `limbd run` running there?"
        )
    return message[1]


def _view(endpoint: str, health: Mapping[str, Any]) -> Group:
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
    offset = "not known yet" if health["clock_ppm"] is None else f"{health['clock_ppm']:+.1f} ppm"
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
        ("clock", offset + error),
        ("tracking", f"{health['tracking']['method']}{', WRONG' if health['tracking']['wrong'] else ''}"),
        ("recording", where if free is None else f"{where}, {free / 1e9:.1f} GB free"),
    ]
