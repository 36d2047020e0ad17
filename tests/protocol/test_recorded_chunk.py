"""A chunk that lies, or would grow beyond all bounds, costs that chunk and no memory."""

import resource
import struct
import zlib
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Chunk, Message
from mcap.writer import CompressionType, Writer

from protocol.message import GAP, encode
from protocol.recorded_chunk import MAX_CHUNK_BYTES, chunk_records
from protocol.recording_reader import MAGIC, read_recording


def content(messages: int = 3) -> bytes:
    builder = RecordBuilder()
    Channel(id=1, topic=GAP, message_encoding="msgpack", metadata={}, schema_id=0).write(builder)
    for k in range(messages):
        Message(1, k, encode(GAP, {"sample0": k})[1], k, k).write(builder)
    return builder.end()


def chunk(data: bytes, compression: str, size: int | None = None, crc: int | None = None) -> Chunk:
    packed = {"": bytes, "zstd": zstandard.ZstdCompressor().compress, "lz4": lz4.frame.compress}
    pack = packed.get(compression, bytes)
    crc = zlib.crc32(data) if crc is None else crc
    return Chunk(compression, pack(data), 0, 0, crc, len(data) if size is None else size)


@pytest.mark.parametrize("compression", ["", "zstd", "lz4"])
def test_what_is_whole_is_read(compression: str) -> None:
    kinds = [type(record) for record in chunk_records(chunk(content(), compression))]
    assert kinds == [Channel, Message, Message, Message]


@pytest.mark.parametrize("compression", ["", "zstd", "lz4"])
@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"size": MAX_CHUNK_BYTES + 1}, f"it would grow to {MAX_CHUNK_BYTES + 1} bytes"),
        ({"size": 2**63}, "it would grow to 9223372036854775808 bytes"),
        ({"size": 10}, "it does not have the 10 bytes that it says"),
        ({"size": 10_000}, "it does not have the 10000 bytes that it says"),
        ({"crc": 7}, "its checksum is another"),
    ],
)
def test_a_chunk_that_lies_is_refused(compression: str, change: dict[str, int], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        list(chunk_records(chunk(content(), compression, **change)))


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_bomb_grows_no_further_than_it_says(compression: str) -> None:
    bomb = chunk(bytes(4 * MAX_CHUNK_BYTES), compression, size=1000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ValueError, match="it does not have the 1000 bytes that it says"):
        list(chunk_records(bomb))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1024 * 16


@pytest.mark.parametrize(("compression", "said"), [("lz4", "no LZ4"), ("br", "compression is 'br'")])
def test_bytes_that_are_none_cost_a_chunk(tmp_path: Path, compression: str, said: str) -> None:
    """As seen: a traceback, for the library raises what nobody foresaw."""
    path = tmp_path / "x.mcap"
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.LZ4, chunk_size=100)
        writer.start()
        channel = writer.register_channel(GAP, "msgpack", 0)
        for k in range(50):
            writer.add_message(channel, k, encode(GAP, {"sample0": k})[1], k, k)
        writer.finish()
    whole = path.read_bytes()
    head = struct.pack("<QQQII", 0, 0, 100, 0, len(compression)) + compression.encode()
    body = head + struct.pack("<Q", 8) + b"not lz4!"
    path.write_bytes(MAGIC + b"\x06" + struct.pack("<Q", len(body)) + body + whole[len(MAGIC) :])
    with read_recording(path) as reader:
        assert [fields["sample0"] for _, fields, _ in reader] == list(range(50))
    assert len(reader.warnings) == 1 and "is damaged and passed over" in reader.warnings[0]
    assert said in reader.warnings[0]


def test_a_chunk_without_a_checksum_is_believed() -> None:
    assert len(list(chunk_records(chunk(content(), "zstd", crc=0)))) == 4
    assert list(chunk_records(chunk(b"", ""))) == []


def test_what_else_is_in_a_chunk_is_passed_over() -> None:
    stranger = bytes([0x7F]) + struct.pack("<Q", 5) + b"hello"
    found = list(chunk_records(chunk(stranger + content(1) + stranger, "zstd")))
    assert [type(record) for record in found] == [Channel, Message]
