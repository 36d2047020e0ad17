"""Writing recordings: MCAP, zstd, the messages byte for byte but those that are recorded as JSON.

The file survives its writer. Chunks are closed twice a second and handed to the kernel, so a kill costs half
a second; once a second the disk itself is made to have them, so a power cut costs little more than one.
"""

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType

from mcap.well_known import SchemaEncoding
from mcap.writer import CompressionType, Writer

from limbcal.errors import DeviceError, ProtocolError
from protocol.recorded_json import JSON_ENCODING, JSON_TOPICS, json_messages, recorded_schema
from protocol.schemas import schema_json

MESSAGE_ENCODING = "msgpack"
ARM_ATTACHMENT = "arm.toml"
CONFIG_ATTACHMENT = "limbd.toml"
#: Bytes that are compressed together; a convention.
CHUNK_BYTES = 512 * 1024
#: What is lost at the most when the writer is killed, and when the power fails [s].
FLUSH_PERIOD_S = 0.5
SYNC_PERIOD_S = 1.0


class RecordingWriter:
    """Writes one recording, with the arm and the config at its beginning.

    Parameters
    ----------
    path : Path
        A file that is not there yet.
    arm_toml, config_toml : str
        Attached as ``arm.toml`` and ``limbd.toml``.
    clock : callable
        Returns the time [s] by which chunks are flushed, never going back.

    Attributes
    ----------
    unsafe : int
        Messages written last that the kernel does not have yet.

    Raises
    ------
    DeviceError
        If the file exists already or cannot be made; from any method: if the disk fails.
    """

    def __init__(
        self,
        path: str | Path,
        arm_toml: str,
        config_toml: str,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.path = Path(path)
        self._clock = clock
        self._channels: dict[tuple[str, str], int] = {}
        self._sequences: dict[str, int] = {}
        self._finished = False
        self.unsafe = self._safe_bytes = 0
        with self._disk():
            self._file = self.path.open("xb")
        self._writer = Writer(self._file, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
        with self._disk():
            self._writer.start(profile="limbcal")
            for name, text in ((ARM_ATTACHMENT, arm_toml), (CONFIG_ATTACHMENT, config_toml)):
                self._writer.add_attachment(0, 0, name, "application/toml", text.encode())
            self._sync()
            _sync_directory(self.path.parent)
        self._flushed_s = self._synced_s = clock()

    @property
    def size_bytes(self) -> int:
        """Bytes in the file so far."""
        return self.path.stat().st_size if self._file.closed else self._file.tell()

    def is_there(self) -> bool:
        """Say whether the file still goes by its name, and is not another one."""
        try:
            found = self.path.stat()
        except OSError:
            return False
        if self._file.closed:
            return True
        mine = os.fstat(self._file.fileno())
        return (found.st_dev, found.st_ino) == (mine.st_dev, mine.st_ino)

    def abandon(self) -> None:
        """Close the file as it is; nothing can be written any more."""
        self._finished = True
        with suppress(OSError):
            self._file.close()

    def _take_back(self) -> None:
        """Close the file without what may be in it of unsafe messages: they go into another one, and not twice."""
        descriptor = os.dup(self._file.fileno())
        self.abandon()  # which tries to write its buffer
        with suppress(OSError):
            os.ftruncate(descriptor, self._safe_bytes)
        os.close(descriptor)

    def write(self, topic: str, payload: bytes, t_ns: int) -> None:
        """Add a message.

        Parameters
        ----------
        topic : str
        payload : bytes
            The second part of the message, exactly as it was sent.
        t_ns : int
            When it was sent [ns], from 0.

        Raises
        ------
        ProtocolError
            If the time is negative, or a message that is to become JSON is none.
        DeviceError
            If the disk fails.
        """
        if topic in JSON_TOPICS:
            found = [(*one, JSON_ENCODING) for one in json_messages(topic, payload, t_ns)]
        else:
            found = [(payload, t_ns, MESSAGE_ENCODING)]
        self._add(topic, found)

    def copy(self, topic: str, data: bytes, t_ns: int, encoding: str) -> None:
        """Add a message of another recording as it was recorded there, in its encoding; else as `write`."""
        self._add(topic, [(data, t_ns, encoding)])

    def _add(self, topic: str, found: Sequence[tuple[bytes, int, str]]) -> None:
        """Add what is recorded of one message: data, time and encoding of each."""
        try:
            for data, t_ns, encoding in found:
                if not 0 <= t_ns < 1 << 64:
                    raise ProtocolError(f"{topic}: time of the message is {t_ns} ns, expected 0 to 2**64 - 1")
                channel = self._channels.get((topic, encoding)) or self._channel(topic, data, encoding)
                sequence = self._sequences.get(topic, 0)
                self._writer.add_message(channel, t_ns, data, t_ns, sequence % (1 << 32))
                self._sequences[topic] = sequence + 1
            self.unsafe += 1
            self._flush_if_due()
        except OSError as error:
            raise self._failed(error) from error

    def _channel(self, topic: str, data: bytes, encoding: str) -> int:
        text = recorded_schema(topic, data) if encoding == JSON_ENCODING else schema_json(topic)
        schema = self._writer.register_schema(topic, SchemaEncoding.JSONSchema, text)
        channel = self._channels[topic, encoding] = self._writer.register_channel(topic, encoding, schema)
        return channel

    def poll(self) -> None:
        """Flush and sync where it is time; call it a few times a second also when no message comes."""
        with self._disk():
            self._flush_if_due()

    def _flush_if_due(self) -> None:
        now = self._clock()
        if now - self._synced_s >= SYNC_PERIOD_S:
            self._sync()
            self._flushed_s = self._synced_s = now
        elif now - self._flushed_s >= FLUSH_PERIOD_S:
            self._flush()
            self._flushed_s = now

    def close(self) -> None:
        """Write the index, make the disk have it all and close the file; harmless when repeated."""
        if self._finished:
            return
        self._finished = True
        with self._disk():
            self._writer.finish()  # type: ignore[no-untyped-call]
            self._file.flush()
            self.unsafe, self._safe_bytes = 0, self._file.tell()
            os.fsync(self._file.fileno())
            self._file.close()

    def __enter__(self) -> "RecordingWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _flush(self) -> None:
        self._writer.flush()  # type: ignore[no-untyped-call]
        self.unsafe, self._safe_bytes = 0, self._file.tell()

    def _sync(self) -> None:
        self._flush()
        os.fsync(self._file.fileno())

    @contextmanager
    def _disk(self) -> Iterator[None]:
        """Turn a failure of the disk into our own; what was written before stays readable as it is."""
        try:
            yield
        except FileExistsError as error:
            raise DeviceError(f"recording {self.path} exists already, expected a new file") from error
        except OSError as error:
            raise self._failed(error) from error

    def _failed(self, error: OSError) -> DeviceError:
        self._finished = True
        if hasattr(self, "_file"):
            self._take_back()
        return DeviceError(f"recording {self.path} cannot be written: {error.strerror}")


def _sync_directory(directory: Path) -> None:
    """Make the disk have the file's name, without which its contents could not be found."""
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
