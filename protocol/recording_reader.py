"""Reading recordings as a stream, so that one whose writer was killed is read up to where it ends."""

import struct
import zlib
from collections.abc import Callable, Collection, Generator, Iterator
from pathlib import Path
from types import TracebackType
from typing import IO, Any, NamedTuple

from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Chunk, McapRecord, Message, Statistics
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from limbcal.errors import DataError, ProtocolError
from protocol.bounded_file import bounded
from protocol.message import decode_payload
from protocol.recorded_chunk import chunk_records
from protocol.recorded_json import JSON_ENCODING, decode_json
from protocol.recording import MESSAGE_ENCODING

MAGIC = b"\x89MCAP0\r\n"
#: No record of ours comes near; a length beyond it is damage, not data.
MAX_RECORD_BYTES = 256 * 1024 * 1024
#: Of a record: its opcode and length; of an attachment: the checksum at its end, 0 for none (MCAP specification).
_HEAD_BYTES, _CRC_BYTES = 9, 4

#: What the library raises at bytes that are no record.
DAMAGE = (McapError, ZstdError, struct.error, ValueError, OverflowError, MemoryError)


class Recorded(NamedTuple):
    """A message as it is recorded: its bytes are in ``encoding``, its time [ns] is the log's."""

    topic: str
    payload: bytes
    t_ns: int
    encoding: str


#: By the encoding of a channel.
DECODE: dict[str, Callable[[str, bytes], dict[str, Any]]] = {
    MESSAGE_ENCODING: decode_payload,
    JSON_ENCODING: decode_json,
}


class RecordingReader(Iterator[tuple[str, dict[str, Any], int]]):
    """Iterates over a recording: topic, fields and time [ns] of each message, in the order written.

    A file that ends too early or is damaged is no error: what can be read is handed out, and ``warnings``
    says what could not. It is complete once the iteration has ended.

    Parameters
    ----------
    path : Path
    topics : collection of str, optional
        Only these; the others are not decoded.

    Attributes
    ----------
    cut : bool
        The file ends without its footer, so it is still written, its writer was killed, or the file was cut.
    warnings : list of str
        A sentence for each thing that could not be read.

    Raises
    ------
    DataError
        If the file cannot be opened.
    ProtocolError
        If it is not an MCAP file; while iterating: if a message is not one, or of another version.
    """

    def __init__(self, path: str | Path, topics: Collection[str] | None = None) -> None:
        self.path = Path(path)
        self.cut = False
        self.warnings: list[str] = []
        self._topics = topics
        _open(self.path).close()
        self._messages = self._decoded()

    def __next__(self) -> tuple[str, dict[str, Any], int]:
        return next(self._messages)

    def payloads(self) -> Iterator["Recorded"]:
        """Iterate over messages as they are recorded, from the beginning."""
        self.cut = False
        self.warnings.clear()
        channels: dict[int, Channel] = {}
        strangers: set[int] = set()
        n_found, n_written = 0, None
        for record in self._unpacked():
            if isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Statistics):
                n_written = record.message_count
            elif isinstance(record, Message):
                n_found += 1
                if record.channel_id not in channels and record.channel_id not in strangers:
                    channels |= self._channels_of_footer()
                channel = channels.get(record.channel_id)
                if channel is None or channel.message_encoding not in DECODE:
                    strangers.add(record.channel_id)
                elif self._topics is None or channel.topic in self._topics:
                    yield Recorded(channel.topic, record.data, record.log_time, channel.message_encoding)
        for channel_id in sorted(strangers):
            self.warnings.append(
                f"{self.path}: channel {channel_id} is unknown or neither msgpack nor JSON, passed over"
            )
        if n_written not in (None, n_found) and not self.warnings:
            self.warnings.append(f"{self.path}: {n_found} messages found, expected {n_written} by its footer")

    def _channels_of_footer(self) -> dict[int, Channel]:
        """Return the channels as repeated at the end, for when the chunk that declared them is damaged."""
        with _open(self.path) as file:
            return {record.id: record for _, record in _records(file) if isinstance(record, Channel)}

    def close(self) -> None:
        """Close the file before the end is reached; harmless otherwise."""
        self._messages.close()

    def __enter__(self) -> "RecordingReader":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _decoded(self) -> Generator[tuple[str, dict[str, Any], int], None, None]:
        for topic, payload, t_ns, encoding in self.payloads():
            try:
                fields = DECODE[encoding](topic, payload)
            except ProtocolError as error:
                raise ProtocolError(f"{self.path}: {error}") from error
            yield topic, fields, t_ns

    def _unpacked(self) -> Iterator[McapRecord]:
        """Yield the records, those inside a chunk in its place.

        Where messages stand in chunks, which have checksums, one beside them is some other record, damaged.
        """
        is_chunked = False
        with _open(self.path) as file:
            for place, record in _records(file):
                if record is None:
                    self.cut = True
                    self.warnings.append(
                        f"{self.path}: the recording has no end yet, or was cut off; all that is there is read"
                    )
                elif isinstance(record, Chunk):
                    is_chunked = True
                    yield from self._opened(record, place)
                elif isinstance(record, Message) and is_chunked:
                    self.warnings.append(
                        f"{self.path}: the record at byte {place} is damaged and passed over: "
                        "a message in no chunk"
                    )
                elif isinstance(record, Attachment) and not _is_sound(file, place):
                    self.warnings.append(
                        f"{self.path}: the attachment at byte {place} is damaged and passed over: "
                        "its checksum is another"
                    )
                else:
                    yield record

    def _opened(self, chunk: Chunk, place: int) -> Iterator[McapRecord]:
        try:
            yield from chunk_records(chunk)
        except DAMAGE as error:
            self.warnings.append(f"{self.path}: the chunk at byte {place} is damaged and passed over: {error}")


def read_recording(path: str | Path, topics: Collection[str] | None = None) -> RecordingReader:
    """Return the messages of a recording, to be iterated over; see `RecordingReader`."""
    return RecordingReader(path, topics)


def recording_attachments(path: str | Path) -> dict[str, bytes]:
    """Return the attachments that stand at the beginning of a recording, ``arm.toml`` and ``limbd.toml``.

    One whose checksum is another is left out: with a digit of it changed an arm is still an arm.

    Raises
    ------
    DataError
        If the file cannot be opened.
    ProtocolError
        If it is not an MCAP file.
    """
    attachments: dict[str, bytes] = {}
    with _open(Path(path)) as file:
        for place, record in _records(file):
            if isinstance(record, Attachment):
                if _is_sound(file, place):
                    attachments[record.name] = record.data
            elif isinstance(record, Chunk) or record is None:
                break
    return attachments


def _records(file: IO[bytes]) -> Iterator[tuple[int, McapRecord | None]]:
    """Yield the records as they stand in the file, each with its place, and None where no more can be read.

    The library's reader stops with one of several exceptions at a cut, depending on what it was reading.
    """
    place = len(MAGIC)
    try:
        for record in StreamReader(bounded(file), emit_chunks=True, record_size_limit=MAX_RECORD_BYTES).records:
            yield place, record
            place = file.tell()
    except DAMAGE:
        yield place, None


def _is_sound(file: IO[bytes], place: int) -> bool:
    """Say whether an attachment that was just read has its checksum, at which the library does not look."""
    length = file.tell() - place - _HEAD_BYTES
    file.seek(place + _HEAD_BYTES)
    content = file.read(length)
    stated = int.from_bytes(content[-_CRC_BYTES:], "little")
    return stated in (0, zlib.crc32(content[:-_CRC_BYTES]))


def _open(path: Path) -> IO[bytes]:
    """Open a file that begins as an MCAP file does, or as one does that was cut there."""
    try:
        file = path.open("rb")
        magic = file.peek(len(MAGIC))[: len(MAGIC)]
    except OSError as error:
        raise DataError(f"recording {path} cannot be read: {error.strerror}") from error
    if not MAGIC.startswith(magic):
        file.close()
        raise ProtocolError(f"{path} begins with {magic!r}, expected an MCAP recording")
    return file
