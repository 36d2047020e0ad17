"""`limbd run` end to end: devices on real ptys, real subscribers, real files."""

import json
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
import zmq
from numpy.typing import NDArray

from arm.arm_file import load_arm, parse_arm
from daemon.__main__ import main
from daemon.virtual_device.virtual_motion import BenchPlan, stretches
from protocol.message import FRAMES, HEALTH, PLOT, RAW, TRIAL
from protocol.recording_reader import read_recording, recording_attachments
from protocol.serial_frame import encode_samples
from protocol.subscriber import Subscriber
from tests.daemon.conftest import SCALE, device_info, resting_counts
from tests.daemon.monitoring.test_metrics import scrape
from tests.free_port import free_port
from tests.patience import PATIENCE_MS

Limbd = Callable[..., Any]
MakeDevice = Callable[..., Any]
Fields = dict[str, Any]
ANY_ENDPOINT = ("--endpoint", "tcp://127.0.0.1:*")
#: Where it does not matter how motion is tracked: the paper's method is loaded in half the time.
PLAIN = (*ANY_ENDPOINT, "--method", "integrate")
COUNT = 5.0 * 9.80665 / 32768


@pytest.fixture
def subscribe() -> Iterator[Callable[..., Subscriber]]:
    made: list[Subscriber] = []

    def connect(endpoint: str, *topics: str) -> Subscriber:
        made.append(Subscriber(context, endpoint, topics))
        return made[-1]

    with zmq.Context() as context:
        yield connect
        for subscriber in made:
            subscriber.close()


def receive(subscriber: Subscriber) -> tuple[str, Fields]:
    message = subscriber.receive(PATIENCE_MS)
    assert message is not None
    return message


def next_health(subscriber: Subscriber) -> Fields:
    while True:
        topic, fields = receive(subscriber)
        if topic == HEALTH:
            return fields


def recorded(path: str, topic: str) -> list[Fields]:
    reader = read_recording(path, [topic])
    found = [fields for _, fields, _ in reader]
    assert not reader.cut, reader.warnings
    return found


def sample_frames(counts: NDArray[np.int16], skip: frozenset[int] = frozenset()) -> bytes:
    """Return frames numbered from 1 at 8 kHz and 1 MHz, without some of them."""
    parts = np.split(counts, len(counts) // 32)
    return b"".join(encode_samples(part, k + 1, k * 4000) for k, part in enumerate(parts) if k not in skip)


def test_the_virtual_arm_is_followed_without_loss(
    limbd: Limbd, subscribe: Callable[..., Subscriber], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    plan = BenchPlan(load_arm("dd-arm"), seed=3, rate_hz=16000.0, trials=1)
    link = tmp_path / "device"
    bench = ("--rate-hz", "16000", "--seed", "3", "--trials", "1", "--speed", "4")
    # Patient: what is sent and received is compared, and not how fast a busy machine reads.
    device = limbd("virtual", "--link", str(link), *bench, "--patient", "--json")
    device.announcement()
    config, metrics_port = tmp_path / "limbd.toml", free_port()
    config.write_text(
        f'[device]\nport = "{link}"\n[arm]\nfile = "dd-arm"\n[tracking]\nmethod = "integrate"\n'
        f'[publish]\nendpoint = "tcp://127.0.0.1:*"\nraw = true\n[metrics]\naddress = "127.0.0.1:{metrics_port}"\n'
    )
    daemon = limbd("run", "--config", str(config), "--record", str(tmp_path / "rec"), "--json")
    announced = daemon.announcement()
    assert announced["rate_hz"] == 16000.0
    subscriber = subscribe(announced["endpoint"], "")
    heard: dict[str, list[Fields]] = {}
    while not (health := heard.get(HEALTH)) or health[-1]["samples"] < 8 * 16000:
        topic, fields = receive(subscriber)
        heard.setdefault(topic, []).append(fields)
    assert subscriber.missed == {}
    tells_how_it_is(announced["endpoint"], capfd)
    is_scraped(metrics_port)
    assert daemon.stop() == 0

    frames = heard[FRAMES]
    for before, after in zip(frames, frames[1:], strict=False):
        assert after["frame0"] == before["frame0"] + before["n"]
        assert abs(after["t0_ns"] - before["t0_ns"] - before["n"] * 1e6) <= 2
    assert max(block["n"] for block in frames) == 10
    assert frames[0]["points"].shape == (frames[0]["n"], 4, 3)
    assert "q_std" not in frames[0]
    assert health[-1]["lost_samples"] == health[-1]["crc_errors"] == 0
    assert health[-1]["recording"] == announced["recording"]
    assert health[-1]["connected"] is True
    assert health[-1]["latency_ms"]["p99"] > 0.0
    assert health[-1]["tracking"] == {
        **{"method": "integrate", "innovation": None, "jolts": 0, "doubted": 0, "wrong": False}
    }
    assert set(health[-1]) >= {
        *("uptime_s", "last_seq", "samples", "lost_samples", "crc_errors", "resyncs", "reconnects", "saturated"),
        *(
            "flat",
            "clock_ppm",
            "latency_ms",
            "connected",
            "recording",
            "disk_free_bytes",
            "v",
            "arm",
            "run",
            "seq",
        ),
    }
    assert {row["ts"] for rows in heard[PLOT] for row in rows["rows"]}

    raw = recorded(announced["recording"], RAW)
    a = np.concatenate([block["a"] for block in raw])
    sent = np.concatenate([s.counts for s, _ in zip(stretches(plan), range(20), strict=False)])[: len(a)]
    assert len(a) > 8 * 16000
    np.testing.assert_array_equal(np.rint(a / COUNT), sent)
    assert [block["sample0"] for block in raw] == np.cumsum([0, *(block["n"] for block in raw)])[:-1].tolist()
    heard_raw = heard[RAW][0]
    np.testing.assert_array_equal(heard_raw["a"], a[heard_raw["sample0"] :][: heard_raw["n"]])
    trial = recorded(announced["recording"], TRIAL)[0]
    assert (trial["trial"], trial["state"], trial["role"]) == (1, "begin", "learn")
    assert (trial["t_ns"] - raw[0]["t0_ns"]) * 1e-9 == pytest.approx(0.5, abs=0.1)  # after the bench's rest
    last = recorded(announced["recording"], HEALTH)[-1]
    assert (last["samples"], last["lost_samples"], last["connected"]) == (len(a), 0, False)
    attached = recording_attachments(announced["recording"])
    assert parse_arm(attached["arm.toml"].decode(), "arm.toml") == plan.arm
    assert "raw = true" in attached["limbd.toml"].decode()
    assert device.stop() == 0
    assert not link.is_symlink()


def tells_how_it_is(endpoint: str, capfd: pytest.CaptureFixture[str]) -> None:
    """`limbd status` beside a running daemon, for a script and for a person."""
    assert main(["status", "--endpoint", endpoint, "--json"]) == 0
    health = json.loads(capfd.readouterr().out)
    assert health["connected"] and health["arm"] == "dd-arm"
    assert health["readings"].keys() == health["still"].keys() == {"s1", "s2", "s3", "s4"}
    assert main(["status", "--endpoint", endpoint, "--once"]) == 0
    said = capfd.readouterr().out
    for word in ("limbd, arm dd-arm", "connected", "samples", "16000 Hz by its INFO", "joint", "reads s1"):
        assert word in said


def is_scraped(port: int) -> None:
    """Prometheus beside a running daemon."""
    found = scrape(port)
    assert found["limbcal_samples_total"] >= 8 * 16000 and found["limbcal_connected"] == 1.0
    assert found["limbcal_samples_lost_total"] == found["limbcal_checksum_errors_total"] == 0.0
    assert 0.0 < found["limbcal_latency_seconds 0.5"] <= found["limbcal_latency_seconds 0.99"]


def test_a_run_counts_and_marks_what_its_device_skips_and_outlives_it(
    limbd: Limbd, pty_device: MakeDevice, subscribe: Callable[..., Subscriber], tmp_path: Path
) -> None:
    counts = resting_counts(16000)
    stream = sample_frames(counts, skip=frozenset({100, 101, 250}))
    broken = bytearray(stream)
    broken[300 * 796 + 100] ^= 0x40  # one bit of the payload of one frame
    device = pty_device(device_info(), bytes(broken[:200_000]) + b"noise in between" + bytes(broken[200_000:]))
    daemon = limbd("run", "--port", device.path, "--arm", "dd-arm", "--record", str(tmp_path), *PLAIN, "--json")
    announced = daemon.announcement()
    subscriber = subscribe(announced["endpoint"], HEALTH)
    while next_health(subscriber)["samples"] < 16000 - 5 * 32:
        pass
    assert device.commands.startswith(b"STOP\nINFO\n") and device.commands.endswith(b"START\n")
    device.close()
    while next_health(subscriber)["connected"]:
        pass
    assert f"warning: port {device.path}: the device went away" in daemon.said
    # Ctrl-C reaches every process of the terminal; the children leave it to the supervisor.
    for process in [*daemon.family, psutil.Process(daemon.process.pid)]:
        process.send_signal(signal.SIGINT)
    assert daemon.wait() == 0

    last = recorded(announced["recording"], HEALTH)[-1]
    assert last["lost_samples"] == 5 * 32  # three skipped, one broken, one torn apart by noise
    assert last["samples"] + last["lost_samples"] == 16000
    assert last["crc_errors"] == 2
    assert last["resyncs"] >= 1
    raw = recorded(announced["recording"], RAW)
    assert sum(block["n"] for block in raw) == last["samples"]
    for block in raw:
        expected = counts[block["sample0"] : block["sample0"] + block["n"]]
        np.testing.assert_array_equal(np.rint(block["a"] / SCALE), expected)
    frames = recorded(announced["recording"], FRAMES)
    assert sum(block["gap"] for block in frames) == 4
    jumps = [b["frame0"] - a["frame0"] - a["n"] for a, b in zip(frames, frames[1:], strict=False)]
    assert min(jumps) == 0 and sum(jump > 0 for jump in jumps) <= 4


def test_garbage_is_told_and_nothing_is_left(limbd: Limbd, pty_device: MakeDevice, tmp_path: Path) -> None:
    device = pty_device(None, chatter=np.random.default_rng(5).bytes(4096))
    record = str(tmp_path / "rec")
    daemon = limbd("run", "--port", device.path, "--arm", "dd-arm", "--record", record, *ANY_ENDPOINT)
    assert daemon.wait() == 3
    assert f"error: port {device.path}: no valid frame in " in daemon.said
    assert daemon.said.count("error:") == 1
    assert "Traceback" not in daemon.said
    assert not list((tmp_path / "rec").iterdir())


def test_ports_and_endpoints_that_are_taken(limbd: Limbd, pty_device: MakeDevice) -> None:
    device, other = pty_device(device_info()), pty_device(device_info())
    first = limbd("run", "--port", device.path, "--arm", "dd-arm", *PLAIN, "--json")
    endpoint = first.announcement()["endpoint"]
    same_port = limbd("run", "--port", device.path, "--arm", "dd-arm", *ANY_ENDPOINT)
    same_endpoint = limbd("run", "--port", other.path, "--arm", "dd-arm", "--endpoint", endpoint)
    assert same_port.wait() == same_endpoint.wait() == 3
    assert f"error: port {device.path} is already taken" in same_port.said
    assert f"error: endpoint {endpoint} is already taken" in same_endpoint.said
    assert first.stop() == 0
    assert device.commands.endswith(b"START\nSTOP\n")


@pytest.mark.parametrize("victim", ["pipeline", "supervisor"])
def test_a_killed_process_takes_all_with_it(
    limbd: Limbd, pty_device: MakeDevice, subscribe: Callable[..., Subscriber], tmp_path: Path, victim: str
) -> None:
    device = pty_device(device_info())
    daemon = limbd("run", "--port", device.path, "--arm", "dd-arm", "--record", str(tmp_path), *PLAIN, "--json")
    announced = daemon.announcement()
    subscriber = subscribe(announced["endpoint"], HEALTH)
    for _ in range(2):  # what was published a second ago is on its way to the disk; the newest may not be
        next_health(subscriber)
    os.kill({**announced["processes"], "supervisor": daemon.process.pid}[victim], signal.SIGKILL)
    code = daemon.wait()
    assert len(recorded(announced["recording"], HEALTH)) >= 1
    if victim == "pipeline":
        assert code == 3
        assert "error: the pipeline process ended with signal 9, expected it to go on" in daemon.said
    else:
        assert code == -signal.SIGKILL


def test_a_failing_disk_does_not_stop_the_stream(
    limbd: Limbd, subscribe: Callable[..., Subscriber], pty_device: MakeDevice, tmp_path: Path
) -> None:
    device = pty_device(device_info(8000.0))
    daemon = limbd("run", "--port", device.path, "--arm", "dd-arm", "--record", str(tmp_path), *PLAIN, "--json")
    announced = daemon.announcement()
    recorder = psutil.Process(announced["processes"]["recorder"])
    recorder.rlimit(psutil.RLIMIT_FSIZE, (10_000, 10_000))
    subscriber = subscribe(announced["endpoint"], HEALTH, FRAMES)
    next_health(subscriber)
    device.write(sample_frames(resting_counts(8000)))
    while (fields := next_health(subscriber))["recording"] is not None or fields["samples"] < 8000:
        pass
    assert fields["lost_samples"] == 0
    assert daemon.stop() == 3
    assert "cannot be written: File too large" in daemon.said
    assert "error: the recording is incomplete" in daemon.said
