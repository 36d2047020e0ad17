"""A file that is not asked for more than it holds: Python makes room for all that is asked for before it reads."""

import os
from typing import IO, cast

#: Bytes that may be asked for without a look at how long the file is.
_LITTLE_BYTES = 65_536


def bounded(file: IO[bytes]) -> IO[bytes]:
    """Return what reads from where a file stands, as far as it goes; a length that lies costs no memory.

    Parameters
    ----------
    file : IO[bytes]
        Stays the caller's to close.
    """
    return cast(IO[bytes], _BoundedFile(file))  # nothing else is done to it than reading


class _BoundedFile:
    def __init__(self, file: IO[bytes]) -> None:
        self._file = file

    def read(self, length: int) -> bytes:
        """Return as many bytes, or those that are left."""
        if length > _LITTLE_BYTES:
            left = os.fstat(self._file.fileno()).st_size - self._file.tell()
            length = min(length, max(left, 0))
        return self._file.read(length)
