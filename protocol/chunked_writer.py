"""Writing MCAP in compressed chunks, as `mcap.writer.Writer` does, with little to do for each message.

That writer packs each number of each message by itself. Some three hundred messages a second, most of them short,
cost it half as much as compressing all that is in them.
"""

import struct
import zlib
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

#: A message's record up to its data: opcode, length, channel, number, time of logging and of publishing.
_MESSAGE = struct.Struct("<BQHIQQ")
_RECORD_BYTES = 9  # opcode and length, which a record's length leaves out
#: A message index up to its entries: opcode, length, channel, bytes of the entries; each has a time and an offset.
_INDEX = struct.Struct("<BQHI")
#: What the footer's checksum covers of the footer itself, and the bytes that the footer's length counts.
_FOOTER, _FOOTER_BYTES = struct.Struct("<BQQQ"), 20
#: zstd's level 3, but that four bytes are a match, as a number in single precision is, and that its tables of 2^15
#: and 2^14 words fit in a processor's cache: raw samples become a little smaller, in nine tenths of the time.
_LEVEL, _MATCH_BYTES, _HASH_LOG, _CHAIN_LOG = 3, 4, 15, 14


class ChunkedWriter:
    """Writes one file; what it needs are `start`, then messages of registered channels, then `finish`.

    Parameters
    ----------
    stream : binary file
        Stays open.
    chunk_bytes : int
        A chunk that is longer is closed.
    """

    def __init__(self, stream: BinaryIO, chunk_bytes: int) -> None:
        self._stream, self._chunk_bytes = stream, chunk_bytes
        self._parts: list[bytes] = []  # of the chunk that is open
        self._n_byte = 0
        self._entries: dict[int, list[int]] = {}  # by channel: time and offset of each message in it
        self._first_ns = self._last_ns = 0
        parameters = zstandard.ZstdCompressionParameters.from_level(
            _LEVEL,
            source_size=chunk_bytes,
            min_match=_MATCH_BYTES,
            hash_log=_HASH_LOG,
            chain_log=_CHAIN_LOG,
        )
        self._compressor = zstandard.ZstdCompressor(compression_params=parameters)
        self._schemas: list[bytes] = []
        self._channels: list[bytes] = []
        self._attachments: list[bytes] = []
        self._chunks: list[bytes] = []
        self._counts: dict[int, int] = {}
        self._begin_ns = self._end_ns = 0

    def start(self, profile: str) -> None:
        """Write the file's beginning."""
        self._stream.write(MCAP0_MAGIC + _packed(Header(profile, LIBRARY_IDENTIFIER)))

    def add_attachment(self, name: str, media_type: str, data: bytes) -> None:
        """Write an attachment without a time; before the first message."""
        offset = self._stream.tell()
        record = _packed(Attachment(0, 0, name, media_type, data))
        self._stream.write(record)
        index = AttachmentIndex(offset, len(record), 0, 0, len(data), name, media_type)
        self._attachments.append(_packed(index))

    def register_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Add a schema; return its number."""
        number = len(self._schemas) + 1
        self._schemas.append(_packed(Schema(id=number, data=data, encoding=encoding, name=name)))
        self._add(self._schemas[-1])
        return number

    def register_channel(self, topic: str, encoding: str, schema: int) -> int:
        """Add a channel; return its number."""
        number = len(self._channels) + 1
        channel = Channel(id=number, topic=topic, message_encoding=encoding, schema_id=schema, metadata={})
        self._channels.append(_packed(channel))
        self._add(self._channels[-1])
        return number

    def add_message(self, channel: int, t_ns: int, data: bytes, sequence: int) -> None:
        """Add a message, published and logged at one time."""
        entries = self._entries.get(channel)
        if entries is None:
            entries = self._entries[channel] = []
        if len(self._entries) == 1 and not entries:
            self._first_ns = self._last_ns = t_ns
        entries += (t_ns, self._n_byte)
        self._first_ns, self._last_ns = min(self._first_ns, t_ns), max(self._last_ns, t_ns)
        length = _MESSAGE.size - _RECORD_BYTES + len(data)
        self._parts += (_MESSAGE.pack(Opcode.MESSAGE, length, channel, sequence, t_ns, t_ns), data)
        self._n_byte += length + _RECORD_BYTES
        self._close_if_full()

    def flush(self) -> None:
        """Close the chunk, unless no message is in it, and hand all to the kernel."""
        self._close_chunk()
        self._stream.flush()

    def finish(self) -> None:
        """Write the summary and the end."""
        self._close_chunk()
        self._stream.write(_packed(DataEnd(0)))
        start, groups = self._stream.tell(), b"".join(self._summary())
        offsets_start, summary = start + len(groups), groups + b"".join(self._offsets(start))
        crc = zlib.crc32(_FOOTER.pack(Opcode.FOOTER, _FOOTER_BYTES, start, offsets_start), zlib.crc32(summary))
        footer = Footer(summary_start=start, summary_offset_start=offsets_start, summary_crc=crc)
        self._stream.write(summary + _packed(footer) + MCAP0_MAGIC)

    def _add(self, record: bytes) -> None:
        self._parts.append(record)
        self._n_byte += len(record)
        self._close_if_full()

    def _close_if_full(self) -> None:
        if self._n_byte > self._chunk_bytes:
            self._close_chunk()

    def _close_chunk(self) -> None:
        if not self._entries:
            return
        data, self._parts, self._n_byte = b"".join(self._parts), [], 0
        compressed = self._compressor.compress(data)
        chunk = Chunk(
            compression="zstd",
            data=compressed,
            message_start_time=self._first_ns,
            message_end_time=self._last_ns,
            uncompressed_crc=zlib.crc32(data),
            uncompressed_size=len(data),
        )
        start, record = self._stream.tell(), _packed(chunk)
        offsets: dict[int, int] = {}
        indexes, at = [], start + len(record)
        entries, self._entries = self._entries, {}
        for channel, pairs in entries.items():
            offsets[channel] = at
            size = 8 * len(pairs)
            length = _INDEX.size - _RECORD_BYTES + size
            head = _INDEX.pack(Opcode.MESSAGE_INDEX, length, channel, size)
            indexes.append(head + struct.pack(f"<{len(pairs)}Q", *pairs))
            at += length + _RECORD_BYTES
            self._counts[channel] = self._counts.get(channel, 0) + len(pairs) // 2
        index = ChunkIndex(
            message_start_time=self._first_ns,
            message_end_time=self._last_ns,
            chunk_start_offset=start,
            chunk_length=len(record),
            message_index_offsets=offsets,
            message_index_length=at - start - len(record),
            compression="zstd",
            compressed_size=len(compressed),
            uncompressed_size=len(data),
        )
        first = not self._chunks
        self._begin_ns = self._first_ns if first else min(self._begin_ns, self._first_ns)
        self._end_ns = self._last_ns if first else max(self._end_ns, self._last_ns)
        self._chunks.append(_packed(index))
        self._stream.write(record)
        self._stream.write(b"".join(indexes))

    def _groups(self) -> list[tuple[Opcode, list[bytes]]]:
        """Return the records of the summary, by their kinds."""
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._counts.values()),
            message_end_time=self._end_ns,
            message_start_time=self._begin_ns,
            metadata_count=0,
            schema_count=len(self._schemas),
        )
        return [
            (Opcode.SCHEMA, self._schemas),
            (Opcode.CHANNEL, self._channels),
            (Opcode.STATISTICS, [_packed(statistics)]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.ATTACHMENT_INDEX, self._attachments),
            (Opcode.METADATA_INDEX, []),  # the library's writer says of none, too, where they would be
        ]

    def _summary(self) -> list[bytes]:
        return [record for _, records in self._groups() for record in records]

    def _offsets(self, start: int) -> list[bytes]:
        """Return where in the summary, which begins at ``start``, each kind is."""
        offsets = []
        for opcode, records in self._groups():
            length = sum(map(len, records))
            offsets.append(_packed(SummaryOffset(group_opcode=opcode, group_start=start, group_length=length)))
            start += length
        return offsets


def _packed(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    packed: bytes = builder.end()  # type: ignore[no-untyped-call]
    return packed
