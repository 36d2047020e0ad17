"""MCAP files (mcap.dev/spec), written message by message with next to no work for each.

The `mcap` library's own writer takes a message apart into a dozen small writes, and compresses at zstd's default
level, which took a recorder most of its time. Its records are used for what is not written hundreds of times a
second.
"""

import struct
import zlib
from collections import defaultdict
from collections.abc import Sequence
from typing import BinaryIO

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import LIBRARY_IDENTIFIER, MCAP0_MAGIC

#: How chunks are compressed. Samples in single precision repeat each other's four bytes, and little else does: one
#: table of places, of a size that a processor's own cache holds, finds them as well as zstd's default level (a
#: recording at 32 kHz becomes larger by 3 %) in three quarters of its time.
_ZSTD = zstandard.ZstdCompressionParameters(
    strategy=zstandard.STRATEGY_FAST, window_log=19, hash_log=14, min_match=4, target_length=1
)
#: Opcode, length, channel, sequence number, time of logging, of publishing.
_MESSAGE = struct.Struct("<BQHIQQ")
#: Opcode, length, channel, bytes of what follows: time and place of each message.
_INDEX = struct.Struct("<BQHI")
#: Opcode and length of any record.
_RECORD_BYTES = 9
#: What the footer's checksum covers of itself: opcode, length, where the summary and its offsets begin.
_FOOTER = struct.Struct("<BQQQ")
_FOOTER_BYTES = 20


class McapWriter:
    """Writes one file, and closes a chunk when it has become long enough or is asked to.

    Parameters
    ----------
    stream : binary file
        Open for writing, at its beginning.
    chunk_bytes : int
        Length of a chunk, before it is compressed, from which on it is closed.
    profile : str
        What conventions the file follows.
    """

    def __init__(self, stream: BinaryIO, chunk_bytes: int, profile: str) -> None:
        self._stream, self._chunk_bytes = stream, chunk_bytes
        self._compressor = zstandard.ZstdCompressor(compression_params=_ZSTD)
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._attachments: list[AttachmentIndex] = []
        self._chunks: list[ChunkIndex] = []
        self._counts: defaultdict[int, int] = defaultdict(int)
        self._parts: list[bytes] = []  # of the chunk
        self._size = 0
        self._places: dict[int, list[int]] = {}  # by channel, time and place of each message in the chunk
        stream.write(MCAP0_MAGIC)
        stream.write(_packed(Header(profile, LIBRARY_IDENTIFIER)))

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Add an attachment."""
        begin = self._stream.tell()
        record = _packed(Attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=data))
        self._stream.write(record)
        self._attachments.append(
            AttachmentIndex(
                offset=begin,
                length=len(record),
                log_time=0,
                create_time=0,
                data_size=len(data),
                name=name,
                media_type=media_type,
            )
        )

    def channel(self, topic: str, encoding: str, schema_encoding: str, schema: bytes) -> int:
        """Begin a channel with a schema of its own, called as the topic is; return the channel's number."""
        self._schemas.append(Schema(data=schema, encoding=schema_encoding, id=len(self._schemas) + 1, name=topic))
        self._channels.append(
            Channel(
                id=len(self._channels) + 1,
                topic=topic,
                message_encoding=encoding,
                metadata={},
                schema_id=self._schemas[-1].id,
            )
        )
        for record in (_packed(self._schemas[-1]), _packed(self._channels[-1])):
            self._parts.append(record)
            self._size += len(record)
        return len(self._channels)

    def add(self, channel: int, t_ns: int, data: bytes, sequence: int) -> None:
        """Add a message of a channel, with its time and number."""
        places = self._places.get(channel)
        if places is None:
            places = self._places[channel] = []
        places += (t_ns, self._size)
        size = len(data)
        self._parts += (
            _MESSAGE.pack(Opcode.MESSAGE, _MESSAGE.size - _RECORD_BYTES + size, channel, sequence, t_ns, t_ns),
            data,
        )
        self._size += _MESSAGE.size + size
        if self._size > self._chunk_bytes:
            self._close_chunk()

    def flush(self) -> None:
        """Close the chunk, if anything is in it, and hand everything to the system."""
        self._close_chunk()
        self._stream.flush()

    def finish(self) -> None:
        """Write the index behind the last chunk; the file stays open."""
        self._close_chunk()
        self._stream.write(_packed(DataEnd(0)))
        start = self._stream.tell()
        summary, offsets = bytearray(), bytearray()
        for opcode, records in self._summary():
            if records:
                group = b"".join(records)
                place = {"group_start": start + len(summary), "group_length": len(group)}
                offsets += _packed(SummaryOffset(group_opcode=opcode, **place))
                summary += group
        offset_start = start + len(summary)
        summary += offsets
        footer = _FOOTER.pack(Opcode.FOOTER, _FOOTER_BYTES, start, offset_start)
        self._stream.write(summary)
        self._stream.write(_packed(Footer(start, offset_start, zlib.crc32(footer, zlib.crc32(summary)))))
        self._stream.write(MCAP0_MAGIC)

    def _close_chunk(self) -> None:
        if not self._places:
            return
        data = b"".join(self._parts)
        times = [places[0::2] for places in self._places.values()]
        first, last = min(map(min, times)), max(map(max, times))
        compressed = self._compressor.compress(data)
        begin = self._stream.tell()
        chunk = _packed(
            Chunk(
                compression="zstd",
                data=compressed,
                message_end_time=last,
                message_start_time=first,
                uncompressed_crc=zlib.crc32(data),
                uncompressed_size=len(data),
            )
        )
        self._stream.write(chunk)
        at, offsets = begin + len(chunk), {}
        for channel, places in self._places.items():
            offsets[channel] = at
            index = _index(channel, places)
            self._stream.write(index)
            at += len(index)
            self._counts[channel] += len(places) // 2
        self._chunks.append(
            ChunkIndex(
                chunk_length=len(chunk),
                chunk_start_offset=begin,
                compression="zstd",
                compressed_size=len(compressed),
                message_end_time=last,
                message_index_length=at - begin - len(chunk),
                message_index_offsets=offsets,
                message_start_time=first,
                uncompressed_size=len(data),
            )
        )
        self._parts, self._size, self._places = [], 0, {}

    def _summary(self) -> Sequence[tuple[Opcode, list[bytes]]]:
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._counts.values()),
            message_end_time=max((one.message_end_time for one in self._chunks), default=0),
            message_start_time=min((one.message_start_time for one in self._chunks), default=0),
            metadata_count=0,
            schema_count=len(self._schemas),
        )
        return (
            (Opcode.SCHEMA, [*map(_packed, self._schemas)]),
            (Opcode.CHANNEL, [*map(_packed, self._channels)]),
            (Opcode.STATISTICS, [_packed(statistics)]),
            (Opcode.CHUNK_INDEX, [*map(_packed, self._chunks)]),
            (Opcode.ATTACHMENT_INDEX, [*map(_packed, self._attachments)]),
        )


def _packed(record: McapRecord) -> bytes:
    """Return a record as it is written."""
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


def _index(channel: int, places: Sequence[int]) -> bytes:
    size = 8 * len(places)
    header = _INDEX.pack(Opcode.MESSAGE_INDEX, _INDEX.size - _RECORD_BYTES + size, channel, size)
    return header + struct.pack(f"<{len(places)}Q", *places)
