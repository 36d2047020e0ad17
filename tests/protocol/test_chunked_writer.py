"""Files are those of the `mcap` library's own writer, by its own reader; only how they are compressed differs."""

from io import BytesIO

import pytest
from mcap.reader import make_reader
from mcap.records import Chunk, McapRecord, MessageIndex
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from protocol.chunked_writer import ChunkedWriter

CHUNK_BYTES = 2000
#: Channel, time and data; times go back now and then, and a message may be longer than a chunk.
MESSAGES = [
    (1 + k % 2, 10_000 - 7 * k if k % 5 else 20_000 + k, bytes([k]) * (3000 if k == 40 else k)) for k in range(90)
]


def ours(messages: list[tuple[int, int, bytes]]) -> bytes:
    stream = BytesIO()
    writer = ChunkedWriter(stream, CHUNK_BYTES)
    writer.start("limbcal")
    writer.add_attachment("arm.toml", "application/toml", b"schema = 1")
    for name in "ab":
        assert writer.register_channel(name, "msgpack", writer.register_schema(name, "jsonschema", b"{}")) > 0
    for k, (channel, t_ns, data) in enumerate(messages):
        writer.add_message(channel, t_ns, data, k)
    writer.flush()
    writer.flush()  # an empty chunk is none
    writer.finish()
    return stream.getvalue()


def theirs(messages: list[tuple[int, int, bytes]]) -> bytes:
    stream = BytesIO()
    writer = Writer(stream, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
    writer.start("limbcal")
    writer.add_attachment(0, 0, "arm.toml", "application/toml", b"schema = 1")
    for name in "ab":
        writer.register_channel(name, "msgpack", writer.register_schema(name, "jsonschema", b"{}"))
    for k, (channel, t_ns, data) in enumerate(messages):
        writer.add_message(channel, t_ns, data, t_ns, k)
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def records(file: bytes, chunks: bool) -> list[McapRecord]:
    return list(StreamReader(BytesIO(file), emit_chunks=chunks, validate_crcs=True).records)


@pytest.mark.parametrize("n", [0, 1, 2, 90])
def test_what_is_in_a_file_is_what_the_library_writes(n: int) -> None:
    one, other = (make_reader(BytesIO(write(MESSAGES[:n]))) for write in (ours, theirs))
    read, expected = one.get_summary(), other.get_summary()
    assert read is not None and expected is not None
    assert (read.schemas, read.channels, read.statistics) == (
        expected.schemas,
        expected.channels,
        expected.statistics,
    )
    assert [x.uncompressed_size for x in read.chunk_indexes] == [
        x.uncompressed_size for x in expected.chunk_indexes
    ]
    assert list(one.iter_attachments()) == list(other.iter_attachments())
    for in_order in (True, False):
        mine, its = (list(r.iter_messages(log_time_order=in_order)) for r in (one, other))
        assert [found[2] for found in mine] == [found[2] for found in its]
        assert len(mine) == n


def test_chunks_are_the_library_s_and_checked() -> None:
    """By their checksums too, and the indexes after each."""
    mine, its = (records(write(MESSAGES), chunks=True) for write in (ours, theirs))
    assert [type(one) for one in mine] == [type(one) for one in its]
    for one, other in zip(mine, its, strict=True):
        if isinstance(one, MessageIndex):
            assert one == other
        if isinstance(one, Chunk):
            assert isinstance(other, Chunk)
            assert one.uncompressed_crc == other.uncompressed_crc
            assert one.message_start_time == other.message_start_time
            assert one.message_end_time == other.message_end_time
    assert sum(isinstance(one, Chunk) for one in mine) > 3


def test_offsets_lead_to_the_messages() -> None:
    """The reader seeks by the index of a chunk where only some time is asked for."""
    reader = make_reader(BytesIO(ours(MESSAGES)), validate_crcs=True)
    found = [message.data for _, _, message in reader.iter_messages(starting_at=20_000)]
    assert found == [data for _, t_ns, data in MESSAGES if t_ns >= 20_000]
