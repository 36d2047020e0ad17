"""Reading a recording while it is written: from its beginning on, and then what comes."""

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import IO, Any

from mcap.records import Channel, Chunk, Message
from mcap.stream_reader import StreamReader

from limbcal.errors import ProtocolError
from protocol.bounded_file import bounded
from protocol.recorded_chunk import chunk_records
from protocol.recording_files import files_of
from protocol.recording_reader import DAMAGE, DECODE, MAGIC, MAX_RECORD_BYTES


class RecordingFollower:
    """Hands out the messages of a recording, each once, as far as its writer has come.

    Its further files are read after the first, as soon as they are there.

    Parameters
    ----------
    path : str or Path
        Any file of the recording.
    topics : collection of str
        Only these.

    Attributes
    ----------
    found : bool
        Whether there is a file of it that could be opened.
    """

    def __init__(self, path: str | Path, topics: Collection[str]) -> None:
        self._path, self._topics = Path(path), topics
        self._done: set[Path] = set()
        self._file: _GrowingFile | None = None
        self.found = False
        self._open_next()
        self._messages = self._follow()

    def next(self) -> tuple[str, dict[str, Any]] | None:
        """Return topic and fields of the next message, or None if it cannot be read yet."""
        return next(self._messages)

    def close(self) -> None:
        """Close the file; harmless when repeated."""
        if self._file is not None:
            self._file.close()

    def _follow(self) -> Iterator[tuple[str, dict[str, Any]] | None]:
        while True:
            if self._file is None and not self._open_next():
                yield None
                continue
            file = self._file
            assert file is not None
            over = self._next_path() is not None  # looked for first: what is read after that is all there is
            yield from file.read(self._topics)
            if over:
                self._close_file()
            elif self._next_path() is None:
                yield None

    def _next_path(self) -> Path | None:
        return next((path for path in files_of(self._path) if path not in self._done), None)

    def _open_next(self) -> bool:
        path = self._next_path()
        if path is None:
            return False
        self._done.add(path)
        try:
            self._file = _GrowingFile(path)
        except OSError:  # removed meanwhile, or another user's: the next one may be there
            return self._open_next()
        self.found = True
        return True

    def _close_file(self) -> None:
        self.close()
        self._file = None


class _GrowingFile:
    def __init__(self, path: Path) -> None:
        self._file: IO[bytes] = path.open("rb")
        self._good = 0  # everything before was read
        self._channels: dict[int, Channel] = {}

    def read(self, topics: Collection[str]) -> Iterator[tuple[str, dict[str, Any]]]:
        for record in self._records():
            if isinstance(record, Channel):
                self._channels[record.id] = record
            elif isinstance(record, Message):
                channel = self._channels.get(record.channel_id)
                decode = None if channel is None else DECODE.get(channel.message_encoding)
                if channel is None or decode is None or channel.topic not in topics:
                    continue
                try:
                    yield channel.topic, decode(channel.topic, record.data)
                except ProtocolError:  # not a message of this version: as if it had never come
                    continue

    def close(self) -> None:
        self._file.close()

    def _records(self) -> Iterator[Any]:
        """Yield the records from where it stopped last time up to what is not whole yet."""
        self._file.seek(self._good)
        if not self._good and len(self._file.read(len(MAGIC))) == len(MAGIC):
            self._good = len(MAGIC)
        if not self._good:
            return
        self._file.seek(self._good)
        reader = StreamReader(
            bounded(self._file), skip_magic=True, emit_chunks=True, record_size_limit=MAX_RECORD_BYTES
        )
        records = iter(reader.records)
        while True:
            try:
                record = next(records, None)
            except DAMAGE:  # the writer is in the middle of it
                return
            self._good = self._file.tell()
            if record is None:
                return
            yield from self._unpacked(record)

    def _unpacked(self, record: object) -> Iterator[object]:
        if not isinstance(record, Chunk):
            yield record
            return
        try:
            yield from chunk_records(record)
        except DAMAGE:
            return
