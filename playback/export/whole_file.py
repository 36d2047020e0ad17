"""Files that are there whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from limbcal.errors import DeviceError


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a path beside the one wanted, which takes its name once all is written; else nothing is left of it.

    Raises
    ------
    DeviceError
        If the disk fails.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield part
        os.replace(part, path)
    except OSError as error:
        raise DeviceError(f"{path} cannot be written: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
