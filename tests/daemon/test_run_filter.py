"""`limbd run` with the filter, end to end: what it finds, claims and records, and that others can read it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import zmq

from fitter.data.recordings import read_frames
from playback.recording_source import recording_source
from protocol.message import FRAMES, HEALTH, PLOT, RAW, TRIAL
from protocol.recording_reader import read_recording
from protocol.subscriber import Subscriber
from tests.patience import PATIENCE_MS

Limbd = Callable[..., Any]
Fields = dict[str, Any]
#: A test machine may be busy, or full.
OF_THE_MACHINE = {"behind", "disk"}
ANY_ENDPOINT = ("--endpoint", "tcp://127.0.0.1:*")


def recorded(path: str, topic: str) -> list[Fields]:
    return [fields for _, fields, _ in read_recording(path, [topic])]


def test_the_filter_follows_the_virtual_arm(limbd: Limbd, tmp_path: Path) -> None:
    rate_hz, motions_s = 8000.0, 13.5
    arguments = ("--rate-hz", str(rate_hz), "--seed", "3", "--trials", "2", "--noise", "0.5", "--speed", "2")
    truth_file = tmp_path / "truth.npz"
    device = limbd("virtual", *arguments, "--truth", str(truth_file), "--json")
    port = device.announcement()["port"]
    to = ("--method", "filter", "--record", str(tmp_path), *ANY_ENDPOINT, "--json")
    daemon = limbd("run", "--port", port, "--arm", "dd-arm", *to)
    announced = daemon.announcement()
    with zmq.Context() as context, Subscriber(context, announced["endpoint"], [HEALTH]) as subscriber:
        health: Fields = {"samples": 0}
        while health["samples"] < (motions_s + 0.5) * rate_hz:
            message = subscriber.receive(PATIENCE_MS)
            assert message is not None
            health = message[1]
    assert daemon.stop() == 0
    assert device.stop() == 0

    assert set(health["tracking"]) == {"method", "innovation", "jolts", "doubted", "wrong"}
    assert health["tracking"]["method"] == "filter"
    assert 0.1 < health["tracking"]["innovation"] < 2.0
    assert not any(fields["tracking"]["wrong"] for fields in recorded(announced["recording"], HEALTH))
    alarms = {alarm["name"] for fields in recorded(announced["recording"], HEALTH) for alarm in fields["alarms"]}
    assert alarms <= OF_THE_MACHINE
    first_ns = recorded(announced["recording"], RAW)[0]["t0_ns"]
    blocks = recorded(announced["recording"], FRAMES)
    assert [block["frame0"] for block in blocks] == np.cumsum([0, *(block["n"] for block in blocks)])[:-1].tolist()
    assert {block["method"] for block in blocks} == {"filter"}
    q, q_std = (np.concatenate([block[name] for block in blocks]) for name in ("q", "q_std"))
    # Stamps follow arrivals, which a busy machine delays; frames are 1 ms apart by the device's clock.
    t = 1e-9 * (blocks[0]["t0_ns"] - first_ns) + 1e-3 * np.arange(len(q))
    truth = np.load(truth_file)
    # A machine that is busy elsewhere may lose samples, which is said: angles are known less from there on.
    lost = np.concatenate([np.full(block["n"], block["gap"]) for block in blocks])
    known = np.cumsum(lost) == 0
    assert health["lost_samples"] > 0 or known.all()
    moved = (t < motions_s) & known
    assert np.abs(truth["q1"]).max() > 0.5
    for j in range(2):
        true = np.interp(t[moved], truth["t"], truth[f"q{j + 1}"])
        assert np.rad2deg(np.abs(q[moved, j] - true)).max(initial=0.0) < 1.0
    assert (q_std > 0.0).all()
    assert np.rad2deg(q_std[known]).max(initial=0.0) < 5.0
    phases = [(trial["trial"], trial["state"]) for trial in recorded(announced["recording"], TRIAL)]
    assert phases == [(1, "begin"), (1, "end"), (2, "begin"), (2, "end")]
    rows = [row for message in recorded(announced["recording"], PLOT) for row in message["rows"]]
    assert all(row["q_std1"] > 0.0 for row in rows)
    for motion in read_frames([Path(announced["recording"])], 2):
        assert motion.columns["q_std"].shape == motion.columns["q"].shape
    source = recording_source(Path(announced["recording"]), None)
    assert (source.trials, source.notes) == ((1, 2), ())
