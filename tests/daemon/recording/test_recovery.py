"""Of a recording that was cut anywhere, all whole messages are saved, and what was saved is proved."""

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from daemon.__main__ import main
from daemon.recording.recovery import recover
from limbcal.errors import DataError, DeviceError
from protocol.message import TRIAL, encode
from protocol.recording import RecordingWriter
from protocol.recording_reader import read_recording, recording_attachments


def message(number: int) -> bytes:
    return encode(TRIAL, {"trial": number, "t_ns": 5, "state": "begin", "role": "learn"})[1]


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path, now = tmp_path_factory.mktemp("rec") / "run.mcap", [0.0]
    with RecordingWriter(path, "arm", "config", clock=lambda: now[0]) as writer:
        for number in range(500):
            now[0] += 0.02
            writer.write(TRIAL, message(number), 10**9 + 20_000_000 * number)
    return path


@given(share=st.floats(0.0, 1.0))
@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_recording_cut_anywhere_is_saved_up_to_half_a_second(
    recording: Path, tmp_path: Path, share: float
) -> None:
    data = recording.read_bytes()
    cut, out = tmp_path / "cut.mcap", tmp_path / "clean.mcap"
    cut.write_bytes(data[: round(share * len(data))])
    out.unlink(missing_ok=True)
    readable = list(read_recording(cut).payloads())
    if not readable and len(recording_attachments(cut)) < 2:
        with pytest.raises(DataError, match="no message can be read"):
            recover(cut, out)
        assert not out.exists()
        return
    found = recover(cut, out)
    clean = list(read_recording(out).payloads())
    assert clean == readable
    assert [(one.topic, json.loads(one.payload)["trial"], one.t_ns) for one in clean] == [
        (TRIAL, k, 10**9 + 20_000_000 * k) for k in range(len(clean))
    ]
    assert found["messages"] == len(clean)
    assert found["whole"] == (share == 1.0 or round(share * len(data)) == len(data))
    assert recording_attachments(out) == {"arm.toml": b"arm", "limbd.toml": b"config"}


@pytest.mark.parametrize("folder", ["br[old]", "br[/old]"])
def test_a_path_is_said_as_it_is(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], folder: str
) -> None:
    cut = tmp_path / folder / "cut.mcap"
    cut.parent.mkdir(parents=True)
    cut.write_bytes(recording.read_bytes()[:-200])
    assert recover(cut)["warnings"]
    assert f"{folder}/cut.mcap" in capsys.readouterr().err


def test_the_command_says_what_it_saved(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(recording.read_bytes()[:-200])
    assert main(["recover", str(cut), "--json"]) == 0
    said = capsys.readouterr()
    document = json.loads(said.out)
    assert document["messages"] == 500 and not document["whole"]
    assert document["out"] == str(tmp_path / "cut.recovered.mcap")
    assert "written and read back" in " ".join(said.err.split())
    assert main(["recover", str(cut)]) == 3  # the clean file is there already
    assert "exists already" in capsys.readouterr().err
    assert main(["recover", str(tmp_path / "none.mcap")]) == 2


def test_a_file_that_does_not_hold_what_was_written_is_no_proof(
    recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = RecordingWriter.copy

    def forget(self: RecordingWriter, topic: str, data: bytes, t_ns: int, encoding: str) -> None:
        if t_ns != 10**9 + 20_000_000 * 7:
            copy(self, topic, data, t_ns, encoding)

    monkeypatch.setattr(RecordingWriter, "copy", forget)
    with pytest.raises(DeviceError, match="does not hold the 500 messages"):
        recover(recording, tmp_path / "out.mcap")
    assert not (tmp_path / "out.mcap").exists()


@pytest.mark.parametrize(("times_ns", "seconds"), [([], 0.0), ([7], 0.0), ([3 * 10**9, 10**9, 2 * 10**9], 2.0)])
def test_what_was_found_is_told_in_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], times_ns: list[int], seconds: float
) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path, "arm", "config") as writer:
        for number, t_ns in enumerate(times_ns):
            writer.write(TRIAL, message(number), t_ns)
    found = recover(path)
    out = tmp_path / "run.recovered.mcap"
    assert found == {
        "file": str(path),
        "out": str(out),
        "messages": len(times_ns),
        "topics": {TRIAL: len(times_ns)} if times_ns else {},
        "seconds": pytest.approx(seconds),
        "whole": True,
        "warnings": [],
    }
    said = capsys.readouterr()
    assert f"run.recovered.mcap: {len(times_ns)} messages, {seconds:.1f} s, written and read back" in " ".join(
        said.out.split()
    )
    assert "warning" not in said.err


def test_what_could_not_be_read_is_warned_of(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    damaged, data = tmp_path / "run.mcap", bytearray(recording.read_bytes())
    data[data.index(b"zstd", data.index(b"zstd") + 4) + 60] ^= 0xFF  # in the second chunk
    damaged.write_bytes(bytes(data))
    found = recover(damaged)
    assert found["whole"] is False and 400 < found["messages"] < 500
    assert len(found["warnings"]) == 1
    assert "warning: " in capsys.readouterr().err


def test_without_arm_and_config_nothing_is_saved(tmp_path: Path) -> None:
    path, cut, out = tmp_path / "run.mcap", tmp_path / "cut.mcap", tmp_path / "out.mcap"
    RecordingWriter(path, "arm", "config").close()
    data = path.read_bytes()
    cut.write_bytes(data[: data.index(b"config") + 20])
    assert recover(cut, out)["messages"] == 0
    assert recording_attachments(out) == {"arm.toml": b"arm", "limbd.toml": b"config"}
    out.unlink()
    cut.write_bytes(data[: data.index(b"config") - 20])
    with pytest.raises(DataError, match=r"cut\.mcap: no message can be read; .*cut off"):
        recover(cut, out)
    assert not out.exists()
