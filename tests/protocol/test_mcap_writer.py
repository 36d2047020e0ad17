"""MCAP files as the `mcap` library's own reader and writer have them."""

import io

import numpy as np
import pytest
import zstandard
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Attachment, Chunk, DataEnd, Footer, Message, SummaryOffset
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from protocol.mcap_writer import McapWriter

TOPICS = {"one": "json", "two": "msgpack"}


def messages(n, size=100):
    rng = np.random.default_rng(n)
    return [(k % 2, 10**15 + (k ^ 1), rng.integers(0, 9, size + k, dtype=np.uint8).tobytes()) for k in range(n)]


def written(sent, chunk_bytes, flush_after=()):
    stream = io.BytesIO()
    writer = McapWriter(stream, chunk_bytes, "limbcal")
    writer.attach("a.toml", "application/toml", b"x = 1")
    channels = [writer.channel(topic, encoding, "jsonschema", b"{}") for topic, encoding in TOPICS.items()]
    for k, (topic, t_ns, data) in enumerate(sent):
        writer.add(channels[topic], t_ns, data, k)
        if k in flush_after:
            writer.flush()
    writer.finish()
    return stream.getvalue()


def by_the_library(sent, chunk_bytes, flush_after=()):
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=chunk_bytes, compression=CompressionType.ZSTD)
    writer.start(profile="limbcal")
    writer.add_attachment(0, 0, "a.toml", "application/toml", b"x = 1")
    channels = []
    for topic, encoding in TOPICS.items():
        schema = writer.register_schema(topic, "jsonschema", b"{}")
        channels.append(writer.register_channel(topic, encoding, schema))
    for k, (topic, t_ns, data) in enumerate(sent):
        writer.add_message(channels[topic], t_ns, data, t_ns, k)
        if k in flush_after:
            writer.flush()
    writer.finish()
    return stream.getvalue()


def records(data):
    """Return the records of a file; chunks without what compression makes of them, and no places in the file."""
    found = []  # the library says of metadata where they would be, also of none
    for record in StreamReader(io.BytesIO(data), emit_chunks=True).records:
        if isinstance(record, SummaryOffset) and record.group_opcode == Opcode.METADATA_INDEX:
            continue
        if isinstance(record, Chunk):
            whole = zstandard.decompress(record.data)
            assert len(whole) == record.uncompressed_size
            record.data = whole
        for name in ("chunk_length", "chunk_start_offset", "compressed_size", "group_start", "summary_start"):
            if hasattr(record, name):
                setattr(record, name, 0)
        if isinstance(record, Footer):
            record.summary_offset_start = record.summary_crc = 0
        if hasattr(record, "message_index_offsets"):
            record.message_index_offsets = sorted(record.message_index_offsets)
        found.append(record)
    return found


@pytest.mark.parametrize("chunk_bytes", [1, 1000, 10**6])
def test_the_records_are_those_that_the_library_writes(chunk_bytes):
    sent = messages(60)
    ours, theirs = (make(sent, chunk_bytes, {7, 8, 40}) for make in (written, by_the_library))
    assert records(ours) == records(theirs)


@pytest.mark.parametrize("n", [0, 1, 60])
def test_places_and_checksums_are_right(n):
    sent = messages(n)
    data = written(sent, 1000)
    reader = make_reader(io.BytesIO(data), validate_crcs=True)
    found = [(message.sequence, message.log_time, message.data) for _, _, message in reader.iter_messages()]
    assert found == sorted(((k, t, data) for k, (_, t, data) in enumerate(sent)), key=lambda one: one[1])
    summary = reader.get_summary()
    assert summary.statistics.message_count == n
    assert [one.name for one in reader.iter_attachments()] == ["a.toml"]
    footer = list(StreamReader(io.BytesIO(data)).records)[-1]
    assert isinstance(footer, Footer) and footer.summary_crc != 0
    one = [message.data for _, _, message in reader.iter_messages(topics=["one"])]
    assert sorted(one) == sorted(data for topic, _, data in sent if topic == 0)


def test_what_was_flushed_can_be_read_without_an_end():
    stream = io.BytesIO()
    writer = McapWriter(stream, 10**6, "limbcal")
    channel = writer.channel("one", "json", "jsonschema", b"{}")
    for k in range(5):
        writer.add(channel, k, b"{}", k)
        if k == 3:
            writer.flush()
    found = []
    with pytest.raises(EndOfFile):
        found.extend(StreamReader(io.BytesIO(stream.getvalue())).records)
    assert [one.sequence for one in found if isinstance(one, Message)] == [0, 1, 2, 3]
    assert not any(isinstance(one, DataEnd | Attachment) for one in found)


def test_samples_shrink_as_they_do_at_the_default_level():
    """Counts of a 16-bit converter in single precision, as `limb/raw` has them."""
    rng = np.random.default_rng(0)
    counts = np.cumsum(rng.normal(0.0, 3.0, (20, 320, 12)), axis=1) + 60.0 * rng.standard_normal((20, 320, 12))
    data = [(0, k, (0.0015 * np.rint(one)).astype(np.float32).tobytes()) for k, one in enumerate(counts)]
    assert len(written(data, 10**6)) < 1.05 * len(by_the_library(data, 10**6))
