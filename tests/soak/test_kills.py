"""SIGKILL at any moment of a recording."""

import json
import random
from pathlib import Path

import psutil
import pytest
import zmq

from daemon.__main__ import main
from protocol.message import FRAMES
from protocol.recording_reader import read_recording
from protocol.subscriber import Subscriber
from tests.daemon.live_run import Limbd
from tests.patience import PATIENCE_MS
from tests.soak import Long

RATE_HZ = 8_000.0


def end_ns(fields: dict[str, int | float]) -> float:
    return fields["t0_ns"] + 1e9 * fields["n"] * fields["dt_s"]


def test_a_kill_costs_a_second_at_most(
    limbd: Limbd, tmp_path: Path, long: Long, capfd: pytest.CaptureFixture[str]
) -> None:
    rng = random.Random(5)
    device = limbd("virtual", "--link", str(tmp_path / "device"), "--rate-hz", str(RATE_HZ), "--json")
    device.announcement()
    lost_s: list[float] = []
    for k in range(long.of(100, 3)):
        endpoint = f"ipc://{tmp_path}/frames{k}"
        into = ("--method", "integrate", "--record", str(tmp_path / "rec"), "--endpoint", endpoint, "--json")
        with zmq.Context() as context, Subscriber(context, endpoint, [FRAMES]) as subscriber:
            daemon = limbd("run", "--port", str(tmp_path / "device"), "--arm", "dd-arm", *into)
            announced = daemon.announcement()
            heard_ns, moment = 0.0, rng.uniform(0.0, 3.0)
            first_ns: float | None = None
            while first_ns is None or heard_ns < first_ns + 1e9 * moment:
                message = subscriber.receive(PATIENCE_MS)
                assert message is not None
                heard_ns = end_ns(message[1])
                first_ns = heard_ns if first_ns is None else first_ns
            everyone = [psutil.Process(daemon.process.pid), *daemon.family]
            for process in everyone:  # the first would start another reader in place of one that was killed
                process.suspend()
            rng.shuffle(everyone)
            for process in everyone:
                process.kill()
            psutil.wait_procs(daemon.family, timeout=PATIENCE_MS / 1000)
            daemon.process.wait()
        recording, out = Path(announced["recording"]), tmp_path / "recovered.mcap"
        capfd.readouterr()
        assert main(["recover", str(recording), "--out", str(out), "--json"]) == 0
        found = json.loads(capfd.readouterr().out)
        kept_ns = max((end_ns(fields) for _, fields, _ in read_recording(out, [FRAMES])), default=first_ns)
        lost_s.append(1e-9 * (heard_ns - kept_ns))
        assert lost_s[-1] <= 1.0
        assert found["messages"] > 0 or heard_ns < first_ns + 1e9
        recording.unlink()
        out.unlink()
    assert device.stop() == 0
    long.note(f"SIGKILL at {len(lost_s)} random moments: {max(lost_s):.2f} s lost at most; recovered each time")
