"""`limb/plot` by the rules of PlotJuggler, written down anew from its ZeroMQ subscriber and its parsers.

The ZeroMQ subscriber (since 3.9, 2024) takes the first of two parts as the topic and makes a parser for it; a
third part would be a time. The MessagePack parser flattens what it finds: the keys of a map are joined to the
topic by ``/``, places in an array are written ``[i]``, numbers and booleans are plotted and all else passed
over. An array as a whole message is a batch of messages (PlotJuggler/PlotJuggler#1285, 2026; versions before
that plot it as ``[i]`` at the time of arrival). With "use field as timestamp" a row's own time counts [s].
"""

import json
import struct
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import msgpack
import numpy as np
import pytest
import zmq

from protocol.message import PLOT
from tests.patience import PATIENCE_MS

Series = dict[str, list[tuple[float, float]]]


def plot(parts: list[bytes], arrival_s: float, stamp: str | None, batches: bool = True) -> Series:
    """Return what PlotJuggler plots of a message: (time, value) by the curve's name."""
    if len(parts) == 1:
        topic, payload = "", parts[0]
    else:
        topic, payload = parts[0].decode(), parts[1]
        arrival_s = float(parts[2]) if len(parts) > 2 else arrival_s
    document = msgpack.unpackb(payload, strict_map_key=True)  # trailing bytes are an error there too
    series: Series = defaultdict(list)
    for row in document if batches and isinstance(document, list) else [document]:
        t = arrival_s
        if stamp is not None and isinstance(row, dict) and isinstance(row.get(stamp), int | float):
            t = float(row[stamp])
        for name, value in flatten(topic, row):
            series[name].append((t, value))
    return series


def flatten(prefix: str, value: Any) -> Iterator[tuple[str, float]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from flatten(f"{prefix}/{key}", item)
    elif isinstance(value, list):
        for k, item in enumerate(value):
            yield from flatten(f"{prefix}[{k}]", item)
    elif isinstance(value, bool | int | float):
        yield prefix, float(value)


@pytest.fixture(scope="module")
def captured(tmp_path_factory: pytest.TempPathFactory) -> list[list[bytes]]:
    """Messages of a real daemon, which reads a virtual device, as they come off the wire."""
    folder = tmp_path_factory.mktemp("plot")
    link, endpoint = folder / "device", f"ipc://{folder}/frames"
    virtual = [sys.executable, "-m", "daemon", "virtual", "--link", str(link), "--json", "--rate-hz", "4000"]
    with subprocess.Popen(virtual, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as device:
        try:
            assert device.stdout is not None
            assert json.loads(device.stdout.readline())
            run = [sys.executable, "-m", "daemon", "run", "--port", str(link), "--json"]
            run += ["--arm", "dd-arm", "--method", "integrate"]
            with (
                zmq.Context() as context,
                context.socket(zmq.SUB) as socket,
                subprocess.Popen(
                    [*run, "--endpoint", endpoint], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
                ) as daemon,
            ):
                try:
                    socket.setsockopt(zmq.RCVTIMEO, PATIENCE_MS)
                    socket.setsockopt(zmq.LINGER, 0)
                    socket.subscribe("limb/plot")  # as it is typed into "Topics"
                    socket.connect(endpoint)
                    assert daemon.stdout is not None
                    assert json.loads(daemon.stdout.readline())  # its kernels are compiled by then
                    return [socket.recv_multipart() for _ in range(30)]
                finally:
                    daemon.terminate()
        finally:
            device.terminate()


def test_every_signal_is_a_curve_over_its_own_time(captured: list[list[bytes]]) -> None:
    curves: Series = defaultdict(list)
    for parts in captured:
        for name, points in plot(parts, arrival_s=0.0, stamp="ts").items():
            curves[name] += points
    signals = {f"{name}{j}" for name in ("q", "dq", "ddq") for j in (1, 2)} | {"tipx", "tipy", "tipz"}
    assert {f"{PLOT}/{name}" for name in signals} <= curves.keys()
    assert all(name.startswith(f"{PLOT}/") and "[" not in name for name in curves)
    t = np.array([point[0] for point in curves[f"{PLOT}/q1"]])
    assert np.all(np.diff(t) > 0.0)
    assert np.diff(t) == pytest.approx(0.01, abs=2e-3)  # 100 Hz, on the device's clock
    for points in curves.values():
        assert [point[0] for point in points] == t.tolist()
        assert np.isfinite([point[1] for point in points]).all()
    assert [point[1] for point in curves[f"{PLOT}/ts"]] == t.tolist()


def test_before_batches_were_known_it_is_still_plotted(captured: list[list[bytes]]) -> None:
    curves = plot(captured[0], arrival_s=5.0, stamp="ts", batches=False)
    assert f"{PLOT}[0]/q1" in curves
    assert {t for points in curves.values() for t, _ in points} == {5.0}


def test_times_keep_their_microseconds(captured: list[list[bytes]]) -> None:
    """The parser turns seconds into ns as `int(ts * 1e9)`: a double has room for that to 0.5 us."""
    for parts in captured:
        for row in msgpack.unpackb(parts[1]):
            assert isinstance(row["ts"], float)
            assert abs(int(row["ts"] * 1e9) - round(row["ts"], 6) * 1e9) < 1000
            assert struct.calcsize("d") == 8


def test_it_is_two_parts_and_a_flat_map_a_row(captured: list[list[bytes]]) -> None:
    for parts in captured:
        assert len(parts) == 2 and parts[0] == b"limb/plot"
        rows = msgpack.unpackb(parts[1])
        assert rows and all(isinstance(value, int | float) for row in rows for value in row.values())
