"""Recordings as they are read, whole, cut and damaged."""

import tracemalloc

import msgpack
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode

from limbcal.errors import DataError, ProtocolError
from protocol.message import FRAMES, RAW, encode
from protocol.recording import RecordingWriter
from protocol.recording_reader import MAGIC, read_recording, recording_attachments

N = 150


class Recording(bytes):
    """The bytes of a file, shown in few words where a test fails."""

    def __repr__(self):
        return f"<{len(self)} bytes>"


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """Return the bytes of a recording of three chunks."""
    path = tmp_path_factory.mktemp("recording") / "whole.mcap"
    now = 0.0
    with RecordingWriter(path, "arm", "config", clock=lambda: now) as writer:
        for k in range(N):
            now += 0.01
            topic = RAW if k % 10 == 0 else FRAMES
            writer.write(topic, encode(topic, {"seq": k, "q": np.full(40, k)})[1], 1000 * k)
    return Recording(path.read_bytes())


@pytest.fixture(scope="module")
def scratch(tmp_path_factory):
    return tmp_path_factory.mktemp("scratch") / "run.mcap"


def read(path, data):
    path.write_bytes(data)
    reader = read_recording(path)
    return [fields["seq"] for _, fields, _ in reader], reader


def test_a_whole_recording(recording, scratch):
    scratch.write_bytes(recording)
    with read_recording(scratch) as reader:
        found = list(reader)
    assert [(topic, fields["seq"], t_ns) for topic, fields, t_ns in found] == [
        (RAW if k % 10 == 0 else FRAMES, k, 1000 * k) for k in range(N)
    ]
    np.testing.assert_array_equal(found[7][1]["q"], np.full(40, 7))
    assert not reader.cut
    assert reader.warnings == []


def test_only_the_topics_asked_for(recording, scratch):
    scratch.write_bytes(recording)
    assert [fields["seq"] for _, fields, _ in read_recording(scratch, [RAW])] == list(range(0, N, 10))


def test_payloads_are_as_they_were_sent(recording, scratch):
    scratch.write_bytes(recording)
    topic, payload, t_ns, encoding = list(read_recording(scratch).payloads())[3]
    assert (topic, t_ns, encoding) == (FRAMES, 3000, "msgpack")
    assert [topic.encode(), payload] == encode(FRAMES, {"seq": 3, "q": np.full(40, 3)})


@settings(max_examples=200)
@given(place=st.floats(0.0, 1.0, exclude_max=True))
def test_a_cut_file_is_read_up_to_the_cut(recording, scratch, place):
    cut = int(place * len(recording))
    found, reader = read(scratch, recording[:cut])
    assert found == list(range(len(found)))
    assert len(found) in (0, 50, 100, N)
    assert reader.cut
    assert len(reader.warnings) == 1
    assert "cut" in reader.warnings[0]


def test_a_file_that_ends_in_zeros_is_cut(recording, scratch):
    """A power cut can leave the length of a file without its contents."""
    footer = recording.rindex(b"zstd")  # somewhere in the last chunk
    found, reader = read(scratch, recording[: footer - 40] + bytes(5000))
    assert found == list(range(len(found)))
    assert reader.cut


@settings(max_examples=200)
@given(place=st.floats(0.0, 1.0, exclude_max=True), bit=st.integers(0, 7))
def test_damage_costs_a_chunk_and_is_said(recording, scratch, place, bit):
    damaged = bytearray(recording)
    damaged[8 + int(place * (len(recording) - 8))] ^= 1 << bit
    found, reader = read(scratch, bytes(damaged))
    assert set(found) <= set(range(N))
    if found != list(range(N)):
        assert reader.warnings
    if not reader.cut:
        assert len(found) >= N - 51


def test_the_first_chunk_damaged_does_not_hide_the_others(recording, scratch):
    damaged = bytearray(recording)
    damaged[recording.index(b"zstd") + 60] ^= 0xFF  # in the chunk that declares the channels
    found, reader = read(scratch, bytes(damaged))
    assert found == list(range(50, N))
    (warning,) = reader.warnings
    opcode = recording.index(b"zstd") - 41
    assert warning.startswith(f"{scratch}: the chunk at byte {opcode} is damaged and passed over: ")


@pytest.mark.parametrize("opcode", [Opcode.MESSAGE_INDEX, Opcode.CHANNEL])
def test_a_record_that_became_a_message_is_passed_over(recording, scratch, opcode):
    """Behind the chunks stand an index of each, and the channels: one bit makes a message of either."""
    damaged = bytearray(recording)
    place = _last_record(recording, opcode)
    damaged[place] = Opcode.MESSAGE
    found, reader = read(scratch, bytes(damaged))
    assert found == list(range(N))
    (warning,) = reader.warnings
    assert f"the record at byte {place} is damaged and passed over" in warning


def _last_record(recording, opcode):
    """Return where the last record of a kind begins, of those that stand in no chunk."""
    place, last = len(MAGIC), -1
    while place < len(recording) - len(MAGIC):
        last = place if recording[place] == opcode else last
        place += 9 + int.from_bytes(recording[place + 1 : place + 9], "little")
    return last


def test_a_chunk_that_is_no_longer_known_as_one_is_missed(recording, scratch):
    damaged = bytearray(recording)
    second = recording.index(b"zstd", recording.index(b"zstd") + 4)
    damaged[second - 41] = 0x7F  # its opcode, now one to pass over
    found, reader = read(scratch, bytes(damaged))
    assert found == [*range(50), *range(100, N)]
    assert reader.warnings == [f"{scratch}: 100 messages found, expected 150 by its footer"]


def test_reading_may_stop_half_way(recording, scratch):
    scratch.write_bytes(recording)
    with read_recording(scratch) as reader:
        assert next(reader)[1]["seq"] == 0


def test_a_message_of_another_version_is_said_with_the_file(scratch):
    scratch.unlink(missing_ok=True)
    with RecordingWriter(scratch, "", "") as writer:
        writer.write(FRAMES, msgpack.packb({"v": 2}), 0)
    with pytest.raises(ProtocolError) as error:
        list(read_recording(scratch))
    assert str(error.value) == f"{scratch}: limb/frames: message version is 2, expected 1"


@pytest.mark.parametrize("function", [read_recording, recording_attachments])
def test_what_is_no_recording_is_said(tmp_path, function):
    (tmp_path / "table.csv").write_text("t,q1\n")
    with pytest.raises(ProtocolError, match="expected an MCAP recording"):
        function(tmp_path / "table.csv")
    with pytest.raises(DataError, match="No such file"):
        function(tmp_path / "none.mcap")
    with pytest.raises(DataError, match="Is a directory"):
        function(tmp_path)


def test_a_record_longer_than_any_is_not_read(tmp_path):
    path, n_byte = tmp_path / "long.mcap", 257 << 20
    with path.open("wb") as file:
        file.write(MAGIC + bytes([Opcode.ATTACHMENT]) + n_byte.to_bytes(8, "little"))
        file.truncate(file.tell() + n_byte)  # a hole, which takes no room on the disk
    tracemalloc.start()
    try:
        with read_recording(path) as reader:
            assert list(reader) == []
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()


def test_attachments_of_a_file_cut_before_them(recording, scratch):
    scratch.write_bytes(recording[:40])
    assert recording_attachments(scratch) == {}


def test_an_attachment_with_another_checksum_is_passed_over(recording, scratch):
    text = b"application/toml" + (3).to_bytes(8, "little")
    damaged = recording.replace(text + b"arm", text + b"are")
    found, reader = read(scratch, damaged)
    assert recording_attachments(scratch) == {"limbd.toml": b"config"}
    assert len(found) == N
    assert len(reader.warnings) == 1 and "the attachment at byte" in reader.warnings[0]
