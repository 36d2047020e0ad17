"""A recording is a device again: `limbd run --replay`, and the same motion bit for bit."""

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zmq

from daemon.__main__ import main
from daemon.recording.recorded_run import RecordedClock, blocks_of, counts_of, device_of
from protocol.message import FRAMES, GAP, HEALTH, RAW, TRIAL, encode
from protocol.recording import RecordingWriter
from protocol.recording_reader import read_recording
from protocol.subscriber import Subscriber
from tests.daemon.conftest import device_info
from tests.patience import PATIENCE_MS

Limbd = Callable[..., Any]
Fields = dict[str, Any]
ANY_ENDPOINT = ("--endpoint", "tcp://127.0.0.1:*")
#: What of a message is of the process that sent it and not of the arm.
OWN = {"run", "last_seq"}  # how often health was sent depends on how long the run took


def recorded(path: Path, topic: str) -> list[Fields]:
    return [fields for _, fields, _ in read_recording(path, [topic])]


def differing(one: Fields, other: Fields) -> set[str]:
    def same(name: str) -> bool:
        x, y = one[name], other[name]
        return x.tobytes() == y.tobytes() and x.dtype == y.dtype if isinstance(x, np.ndarray) else bool(x == y)

    assert one.keys() == other.keys()
    return {name for name in one if name not in OWN and not same(name)}


#: Of the device [Hz]: what its INFO says, and what it is; what is lost and found again is the same at any rate.
RATE_HZ, SAMPLED_HZ = 4000, 3840


def test_a_replay_is_the_run_bit_for_bit(limbd: Limbd, tmp_path: Path) -> None:
    faults = "drop@0+0.1*1, drop@2+1*0.02, unplug@3+0.3, restart@4, flip@5+1*1e-4"
    rates = ("--rate-hz", f"{RATE_HZ}", "--sampled-hz", f"{SAMPLED_HZ}")
    arguments = (*rates, "--seed", "5", "--trials", "1", "--fault", faults, "--json")
    device = limbd("virtual", "--link", str(tmp_path / "device"), *arguments)
    device.announcement()
    into = ("--record", str(tmp_path / "first"), *ANY_ENDPOINT, "--json")
    daemon = limbd("run", "--port", str(tmp_path / "device"), "--arm", "dd-arm", "--method", "filter", *into)
    announced = daemon.announcement()
    first = Path(announced["recording"])
    with zmq.Context() as context, Subscriber(context, announced["endpoint"], [HEALTH]) as subscriber:
        samples = 0
        while samples < 6.5 * SAMPLED_HZ:
            _, health = subscriber.receive(PATIENCE_MS) or pytest.fail("nothing came any more")
            samples = health["samples"] + health["lost_samples"]
    assert daemon.stop() == 0
    assert device.stop() == 0
    assert recorded(first, HEALTH)[-1]["lost_samples"] > 0.25 * RATE_HZ

    again = ("--replay", str(first), "--speed", "2", "--record", str(tmp_path / "second"))
    replay = limbd("run", *again, *ANY_ENDPOINT, "--json")
    second = Path(replay.announcement()["recording"])
    assert replay.wait() == 0
    for topic in (RAW, FRAMES, TRIAL, GAP):
        before, after = (
            [one for one in recorded(path, topic) if one.get("samples") != 0] for path in (first, second)
        )
        assert len(before) == len(after) > 0
        assert [differing(x, y) for x, y in zip(before, after, strict=True)] == [set()] * len(before)
    assert {fields["delay_ms"]["mean"] for fields in recorded(second, HEALTH)} == {None}
    assert device_of(first).rate_hz == device_of(second).rate_hz == RATE_HZ
    assert recorded(second, RAW)[-1]["dt_s"] == pytest.approx(1.0 / SAMPLED_HZ, rel=150e-6)


def raw_fields(sample0: int, a: np.ndarray[Any, Any]) -> Fields:
    message = {"arm": "x", "run": "r", "seq": 0, "sample0": sample0, "t0_ns": 10**9 + 125_000 * sample0}
    return {**message, "dt_s": 1 / 8000, "n": len(a), "a": a.astype(np.float32)}


def make(path: Path, *messages: tuple[str, Fields], attached: tuple[str, str] = ("", "")) -> Path:
    with RecordingWriter(path, *attached) as writer:
        for topic, fields in messages:
            writer.write(topic, encode(topic, fields)[1], 1)
    return path


def health_of(document: object) -> tuple[str, Fields]:
    return HEALTH, {"arm": "x", "run": "r", "seq": 0, "device": document}


@pytest.mark.parametrize("document", [{}, {"device": 3}, {**asdict(device_info()), "rate_hz": "fast"}])
def test_a_device_that_is_none_is_said(
    tmp_path: Path, document: object, capsys: pytest.CaptureFixture[str]
) -> None:
    arm = Path("arm/presets/dd-arm.toml").read_text(encoding="utf-8")
    config = '[device]\nport = "x"\n[arm]\nfile = "dd-arm"\n'
    path = make(tmp_path / "a.mcap", health_of(document), attached=(arm, config))
    assert main(["run", "--replay", str(path), *ANY_ENDPOINT]) == 2
    assert "what it says of the device makes no sense" in capsys.readouterr().err


def test_what_was_not_recorded_by_limbd_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = make(tmp_path / "a.mcap", (TRIAL, {"arm": "x", "run": "r", "seq": 0}))
    assert main(["run", "--replay", str(path)]) == 2
    assert "schema is missing" in capsys.readouterr().err
    assert main(["run", "--replay", str(path), "--port", "/dev/x"]) == 2
    assert "--replay has its own device" in capsys.readouterr().err
    assert main(["run", "--replay", str(tmp_path / "none.mcap")]) == 2


@pytest.mark.parametrize("which", ["arm", "config"])
@pytest.mark.parametrize(
    ("bomb", "said"),
    [("a = " + "[" * 100_000, "nested too deep"), ("a = " + "1" * 6000, "an integer of too many digits")],
    ids=["nesting", "digits"],
)
def test_a_bomb_in_an_attachment_is_one_sentence(
    tmp_path: Path, which: str, bomb: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    arm = Path("arm/presets/dd-arm.toml").read_text(encoding="utf-8")
    config = '[device]\nport = "x"\n[arm]\nfile = "dd-arm"\n'
    attached = (bomb, config) if which == "arm" else (arm, bomb)
    path = make(tmp_path / "a.mcap", health_of(asdict(device_info())), attached=attached)
    assert main(["run", "--replay", str(path), *ANY_ENDPOINT]) == 2
    err = capsys.readouterr().err
    assert said in err and err.count("error:") == 1 and "Traceback" not in err


def test_accelerations_that_are_no_counts_are_refused(tmp_path: Path) -> None:
    channels = len(device_info().channels)
    a = np.full((320, channels), 0.3)
    path = make(tmp_path / "a.mcap", health_of(asdict(device_info())), (RAW, raw_fields(0, a + 1e-4)))
    info = device_of(path)
    with pytest.raises(Exception, match="no counts of test device"):
        counts_of(next(blocks_of(path)), info)


def test_files_that_follow_are_replayed_too(tmp_path: Path) -> None:
    a = np.zeros((80, len(device_info().channels)))
    for k, name in enumerate(["run.mcap", "run-002.mcap", "run-003.mcap"]):
        make(tmp_path / name, health_of(asdict(device_info())), (RAW, raw_fields(80 * k + 5 * (k == 2), a)))
    assert [block.sample0 for block in blocks_of(tmp_path / "run.mcap")] == [0, 80, 165]
    assert [block.sample0 for block in blocks_of(tmp_path / "run-002.mcap")] == [80, 165]
    clock = RecordedClock(tmp_path / "run.mcap")
    assert [clock.utc_ns(1000 * sample) for sample in (0, 79, 80, 165, 166)] == [
        10**9 + 125_000 * sample for sample in (0, 79, 80, 165, 166)
    ]


def test_a_recordings_clock_tells_of_what_lies_behind(tmp_path: Path) -> None:
    """Where a block began is asked when it is full, and a gap behind it may have been met by then."""
    a = np.zeros((80, len(device_info().channels)))
    began = [10**9 + 10_000_000 * k + 300 * (k % 3) for k in range(5)]
    blocks = [(RAW, {**raw_fields(80 * k, a), "t0_ns": t0_ns}) for k, t0_ns in enumerate(began)]
    clock = RecordedClock(make(tmp_path / "run.mcap", health_of(asdict(device_info())), *blocks))
    for k in (4, 1, 3, 0, 2):
        assert [clock.utc_ns(1000 * (80 * k + i)) - began[k] for i in (0, 1, 79)] == [0, 125_000, 9_875_000]
