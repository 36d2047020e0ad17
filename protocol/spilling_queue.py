"""A queue between threads that never loses: what does not fit in memory waits in an anonymous file."""

import struct
import tempfile
import threading
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import IO

from limbcal.errors import DeviceError

#: Kept in memory [bytes]: half a minute of `limb/frames` of a two-joint arm at ten times real time.
MEMORY_BYTES = 64 * 1024 * 1024
#: A file of the queue is given up, and with it its room on the disk, when this much of it was read [bytes].
FILE_BYTES = 64 * 1024 * 1024

_LENGTH = struct.Struct("<I")

Parts = Sequence[bytes]


class SpillingQueue:
    """Messages in the order in which they were put, each once; one thread puts, one takes.

    The oldest ones are in memory, the others in files without a name, which the system removes when the queue is
    closed or the process ends, however it ends.

    Parameters
    ----------
    memory_bytes : int
        Payload kept in memory; one message more may be.
    file_bytes : int
        Size at which a new file is begun; one that was read to its end is closed.
    directory : Path, optional
        Where the files are; the system's place for temporary files unless given.
    """

    def __init__(
        self, memory_bytes: int = MEMORY_BYTES, file_bytes: int = FILE_BYTES, directory: Path | None = None
    ) -> None:
        self._memory_bytes, self._directory = memory_bytes, directory
        self._file_bytes = file_bytes
        self._front: deque[list[bytes]] = deque()
        self._front_bytes = 0
        self._files: deque[_File] = deque()
        self._count = 0
        self._changed = threading.Condition()

    def __len__(self) -> int:
        """Messages that wait."""
        return self._count

    @property
    def memory(self) -> int:
        """Payload in memory [bytes]."""
        return self._front_bytes

    @property
    def spilled(self) -> int:
        """What waits on the disk [bytes], with four for each length."""
        return sum(file.waiting for file in self._files)

    def put(self, parts: Parts) -> None:
        """Add a message; never waits for the one who takes.

        Raises
        ------
        DeviceError
            If it does not fit in memory and the disk cannot take it; then it is not in the queue.
        """
        size = sum(map(len, parts))
        with self._changed:
            if not self._files and self._front_bytes + size <= self._memory_bytes:
                self._front.append(list(parts))
                self._front_bytes += size
            else:
                self._spill(parts)
            self._count += 1
            self._changed.notify()

    def take(self, timeout_s: float = 0.0) -> list[bytes] | None:
        """Return the oldest message, or None if none came in time.

        Raises
        ------
        DeviceError
            If the disk does not give back what it took.
        """
        with self._changed:
            if not self._count and timeout_s > 0.0:
                self._changed.wait_for(lambda: self._count, timeout_s)
            if not self._count:
                return None
            if not self._front:
                self._load()
            parts = self._front.popleft()
            self._front_bytes -= sum(map(len, parts))
            self._count -= 1
            return parts

    def close(self) -> None:
        """Forget what waits and give back the disk; harmless when repeated."""
        with self._changed:
            while self._files:
                self._files.popleft().close()
            self._front.clear()
            self._front_bytes = self._count = 0

    def _spill(self, parts: Parts) -> None:
        try:
            if not self._files or self._files[-1].written >= self._file_bytes:
                self._files.append(_File(self._directory))
            self._files[-1].write(parts)
        except OSError as error:
            raise DeviceError(
                f"{self._directory or tempfile.gettempdir()}: {self._count} messages wait, and the next cannot be "
                f"written there: {error.strerror}"
            ) from error

    def _load(self) -> None:
        """Take messages from the oldest file into memory, up to half of what may be there."""
        try:
            file = self._files[0]
            while file.waiting and (not self._front or self._front_bytes < self._memory_bytes // 2):
                parts = file.read()
                self._front.append(parts)
                self._front_bytes += sum(map(len, parts))
        except (OSError, struct.error) as error:
            raise DeviceError(f"messages that waited on the disk cannot be read again: {error}") from error
        if not file.waiting:
            self._files.popleft().close()


class _File:
    """Messages one after the other: the number of parts, and each part behind its length."""

    def __init__(self, directory: Path | None) -> None:
        self._file: IO[bytes] = tempfile.TemporaryFile(prefix="limbcal-", dir=directory)  # noqa: SIM115
        self.written = self._read = 0

    @property
    def waiting(self) -> int:
        """Bytes that were not read yet."""
        return self.written - self._read

    def write(self, parts: Parts) -> None:
        """Add a message; one that fails half-way leaves no trace."""
        record = b"".join([_LENGTH.pack(len(parts)), *(_LENGTH.pack(len(part)) + part for part in parts)])
        self._file.seek(self.written)
        self._file.write(record)
        self._file.flush()
        self.written += len(record)

    def read(self) -> list[bytes]:
        """Return the oldest message that was not read yet."""
        self._file.seek(self._read)
        (count,) = _LENGTH.unpack(self._file.read(_LENGTH.size))
        parts = []
        for _ in range(count):
            (length,) = _LENGTH.unpack(self._file.read(_LENGTH.size))
            parts.append(self._file.read(length))
        self._read += _LENGTH.size * (1 + count) + sum(map(len, parts))
        return parts

    def close(self) -> None:
        """Give it back to the disk."""
        self._file.close()
