"""What the command `mcap doctor` looks at, written down anew, with the mcap library as the parser only."""

import zlib
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

from mcap.data_stream import ReadDataStream
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Schema,
    Statistics,
)
from mcap.stream_reader import StreamReader, breakup_chunk
from zstandard import ZstdDecompressor

HEADER_BYTES = 9  # of a record: its kind, and its length


@dataclass
class Complaints:
    errors: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def examine(path: Path) -> Complaints:  # noqa: PLR0912, PLR0915 - it follows the list of the tool's checks
    """Return what is wrong with a file (errors), and what its readers may stumble over (warnings)."""
    found = Complaints()
    data = path.read_bytes()
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    chunks: dict[int, tuple[Chunk, list[MessageIndex]]] = {}
    chunk_indexes: dict[int, ChunkIndex] = {}
    kinds: set[type[McapRecord]] = set()
    times: list[int] = []
    counts: dict[int, int] = {}
    statistics: list[Statistics] = []
    last_chunk = None

    def message(record: Message, where: str) -> None:
        if record.channel_id not in channels:
            found.errors.append(f"{where}: message of unknown channel {record.channel_id}")
        if times and record.log_time < max(times):
            found.warnings.append(f"{where}: log time goes back to {record.log_time}")
        times.append(record.log_time)
        counts[record.channel_id] = counts.get(record.channel_id, 0) + 1

    def described(record: McapRecord, again: bool) -> None:
        if isinstance(record, Schema):
            if record.id == 0 or not record.encoding:
                found.errors.append(f"schema {record.id} {record.name!r}: no id or no encoding")
            if record.id in schemas and schemas[record.id] != record:
                found.errors.append(f"schema {record.id} is given twice, differently")
            if again and record.id not in schemas:
                found.errors.append(f"schema {record.id} is only in the summary")
            schemas[record.id] = record
        elif isinstance(record, Channel):
            if record.schema_id != 0 and record.schema_id not in schemas:
                found.errors.append(f"channel {record.topic} has the unknown schema {record.schema_id}")
            if record.id in channels and channels[record.id] != record:
                found.errors.append(f"channel {record.id} is given twice, differently")
            channels[record.id] = record

    with path.open("rb") as file:
        reader = StreamReader(file, emit_chunks=True, validate_crcs=True)
        for record in reader.records:
            kinds.add(type(record))
            if isinstance(record, Header):
                if not record.library:
                    found.warnings.append("the header names no library")
                if record.profile not in ("", "ros1", "ros2"):
                    found.warnings.append(f"profile {record.profile!r} is not a well-known one")
            elif isinstance(record, Schema | Channel):
                described(record, DataEnd in kinds)
            elif isinstance(record, Message):
                found.warnings.append("a message outside of a chunk, which readers with an index miss")
                message(record, "data")
            elif isinstance(record, Chunk):
                last_chunk = file.tell() - HEADER_BYTES - _chunk_bytes(record)
                chunks[last_chunk] = (record, [])
                for inner in _inside(record, found):
                    described(inner, False)
                    if isinstance(inner, Message):
                        message(inner, f"chunk at {last_chunk}")
            elif isinstance(record, MessageIndex):
                assert last_chunk is not None
                chunks[last_chunk][1].append(record)
            elif isinstance(record, ChunkIndex):
                chunk_indexes[record.chunk_start_offset] = record
            elif isinstance(record, Statistics):
                statistics.append(record)
            elif isinstance(record, Footer) and record.summary_start:
                crc = zlib.crc32(data[record.summary_start : len(data) - 8 - 4])
                if record.summary_crc not in (0, crc):
                    found.errors.append("the summary's checksum is wrong")
    found.errors += [f"no {kind.__name__} record" for kind in (DataEnd, Footer, Statistics) if kind not in kinds]
    _compare(found, chunks, chunk_indexes)
    for given in statistics:
        if given.message_count != len(times) or given.channel_message_counts != counts:
            found.errors.append(f"statistics tell of {given.message_count} messages, found {len(times)}")
        if times and (given.message_start_time, given.message_end_time) != (min(times), max(times)):
            found.errors.append("statistics tell of another time than the messages")
        if (given.schema_count, given.channel_count, given.chunk_count) != (
            len(schemas),
            len(channels),
            len(chunks),
        ):
            found.errors.append("statistics miscount schemas, channels or chunks")
    return found


def _chunk_bytes(chunk: Chunk) -> int:
    return 8 + 8 + 8 + 4 + 4 + len(chunk.compression) + 8 + len(chunk.data)


def _plain(chunk: Chunk) -> bytes:
    if chunk.compression == "zstd":
        return ZstdDecompressor().decompress(chunk.data, max_output_size=max(1, chunk.uncompressed_size))
    assert chunk.compression == ""
    return chunk.data


def _inside(chunk: Chunk, found: Complaints) -> list[McapRecord]:
    plain = _plain(chunk)
    if len(plain) != chunk.uncompressed_size:
        found.errors.append("a chunk's size is not as given")
    if chunk.uncompressed_crc not in (0, zlib.crc32(plain)):
        found.errors.append("a chunk's checksum is wrong")
    records = breakup_chunk(chunk)
    times = [record.log_time for record in records if isinstance(record, Message)]
    if times and (chunk.message_start_time, chunk.message_end_time) != (min(times), max(times)):
        found.errors.append("a chunk tells of another time than its messages")
    return records


def _compare(
    found: Complaints, chunks: dict[int, tuple[Chunk, list[MessageIndex]]], indexes: dict[int, ChunkIndex]
) -> None:
    """Hold the indexes against the chunks."""
    if chunks.keys() != indexes.keys():
        found.errors.append(f"chunks at {sorted(chunks)}, but indexes for {sorted(indexes)}")
    for offset, (chunk, given) in chunks.items():
        plain, entries = _plain(chunk), 0
        for index in given:
            for log_time, place in index.records:
                stream = ReadDataStream(BytesIO(plain[place:]))
                kind, length = stream.read1(), stream.read8()
                record = Message.read(stream, length)
                if kind != 5 or (record.channel_id, record.log_time) != (index.channel_id, log_time):
                    found.errors.append(f"chunk at {offset}: an index points beside its message")
                entries += 1
        n_message = sum(isinstance(record, Message) for record in _inside(chunk, Complaints()))
        if entries != n_message:
            found.errors.append(f"chunk at {offset}: {entries} messages in the index, found {n_message}")
