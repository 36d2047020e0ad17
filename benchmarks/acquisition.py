"""The daemon on the virtual arm in real time: samples lost, latency, delay, and each process's share of a core.

A process's share of a core is its CPU time for a second of the stream, at a speed of 1.
"""

import argparse
import json
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import psutil
import zmq
from rich.table import Table

from limbcal.arguments import Parser, common_options
from limbcal.command import console, run_command
from limbcal.errors import DeviceError
from protocol.message import HEALTH
from protocol.subscriber import Subscriber

_SETTLE_S = 2.0
_STOP_S = 60.0


@dataclass(frozen=True)
class Measurement:
    """What was seen: CPU shares in percent of one core, by process; delays are those of `limb/health`."""

    seconds: float
    method: str
    rate_hz: float
    samples: int
    lost_samples: int
    worst_latency_p99_ms: float
    mean_delay_ms: float
    worst_delay_ms: float
    cpu_percent: Mapping[str, float]


def measure(seconds: float, rate_hz: float, speed: float, method: str) -> Measurement:
    """Stream for a time and watch.

    Raises
    ------
    DeviceError
        If one of the programs does not start.
    """
    with tempfile.TemporaryDirectory(prefix="limbcal-") as room:
        port = f"{room}/port"
        device = _start("virtual", "--link", port, "--rate-hz", str(rate_hz), "--speed", str(speed))
        try:
            _announced(device, "virtual")
            arguments = ("--port", port, "--arm", "dd-arm", "--method", method, "--record", room)
            daemon = _start("run", *arguments, "--endpoint", "tcp://127.0.0.1:*")
            try:
                return _watch(device, daemon, _announced(daemon, "run"), seconds)
            finally:
                _stop(daemon)
        finally:
            _stop(device)


def _watch(
    device: "subprocess.Popen[str]", daemon: "subprocess.Popen[str]", announced: Mapping[str, Any], seconds: float
) -> Measurement:
    time.sleep(_SETTLE_S)  # what happens once, at the start, is no share of the stream
    processes = {"virtual device": psutil.Process(device.pid), "supervisor": psutil.Process(daemon.pid)}
    for child in psutil.Process(device.pid).children():
        if "multiprocessing.spawn" in " ".join(child.cmdline()):
            processes["virtual motion"] = child
    processes |= {name: psutil.Process(pid) for name, pid in announced["processes"].items()}
    context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
    subscriber = Subscriber(context, announced["endpoint"], [HEALTH])
    try:
        before = {name: _cpu_s(process) for name, process in processes.items()}
        begin = time.monotonic()
        latencies: list[float] = [0.0]
        delays: list[tuple[float, float]] = []
        fields: dict[str, Any] = {}
        while time.monotonic() < begin + seconds:
            message = subscriber.receive(500)
            if message is not None:
                fields = message[1]
                latencies.append(fields["latency_ms"]["p99"] or 0.0)
                delays.append((fields["delay_ms"]["mean"] or 0.0, fields["delay_ms"]["max"] or 0.0))
        elapsed = time.monotonic() - begin
        shares = {name: 100.0 * (_cpu_s(process) - before[name]) / elapsed for name, process in processes.items()}
    finally:
        subscriber.close()
        context.term()
    means, worst = zip(*delays, strict=True)
    return Measurement(
        elapsed,
        fields["tracking"]["method"],
        announced["rate_hz"],
        fields["samples"],
        fields["lost_samples"],
        max(latencies),
        sum(means) / len(means),
        max(worst),
        shares,
    )


def _start(*arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "daemon", *arguments, "--json"], stdout=subprocess.PIPE, text=True
    )


def _announced(process: "subprocess.Popen[str]", name: str) -> dict[str, Any]:
    line = "" if process.stdout is None else process.stdout.readline()
    if not line:
        raise DeviceError(f"limbd {name} ended with exit code {process.wait()}, expected it to start")
    document: dict[str, Any] = json.loads(line)
    return document


def _stop(process: "subprocess.Popen[str]") -> None:
    process.send_signal(signal.SIGTERM)
    process.wait(_STOP_S)
    if process.stdout is not None:
        process.stdout.close()


def _cpu_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def main(argv: list[str] | None = None) -> int:
    """Measure and show."""
    parser = Parser(prog="benchmarks.acquisition", description=__doc__, parents=[common_options()])
    parser.add_argument("--seconds", type=float, default=60.0, metavar="N")
    parser.add_argument("--rate-hz", type=float, default=32000.0, metavar="R")
    parser.add_argument("--speed", type=float, default=1.0, metavar="X")
    parser.add_argument("--method", default="filter", metavar="M", help="filter (default) or integrate")
    parser.set_defaults(action=_measure_and_show)
    return run_command(parser, argv)


def _measure_and_show(arguments: argparse.Namespace) -> Mapping[str, object]:
    found = measure(arguments.seconds, arguments.rate_hz, arguments.speed, arguments.method)
    table = Table(
        title=f"{found.method}: {found.samples} samples at {found.rate_hz:g} Hz, {found.lost_samples} lost; "
        f"latency p99 at most {found.worst_latency_p99_ms:.1f} ms; "
        f"delay {found.mean_delay_ms:.1f} ms, at most {found.worst_delay_ms:.1f} ms"
    )
    table.add_column("process")
    table.add_column("share of a core", justify="right")
    for name, share in found.cpu_percent.items():
        table.add_row(name, f"{share:.1f} %")
    console.print(table)
    return asdict(found)


if __name__ == "__main__":
    sys.exit(main())
