"""How far a file may grow when it is read: a few megabytes of zeros can be packed into a kilobyte."""

from pathlib import Path

from limbcal.errors import DataError

#: What is asked of a file may become so large whatever its own size is [bytes]: six million rows
#: of a dozen columns.
ALWAYS_BYTES = 512 * 1024 * 1024
#: … or this many times the file's own size. Measured motion packs to a third or a tenth, zeros to a thousandth.
MOST_TIMES = 50


def require_modest(path: Path, expanded_bytes: int, what: str) -> None:
    """Refuse to read what would grow beyond bounds.

    Parameters
    ----------
    path : Path
    expanded_bytes : int
        What is asked for, unpacked.
    what : str
        For the sentence, such as ``the columns asked for``.

    Raises
    ------
    DataError
        If that is more than any file may become, and too much for one of this size.
    """
    size = path.stat().st_size
    if expanded_bytes > max(ALWAYS_BYTES, MOST_TIMES * size):
        raise DataError(
            f"{path}: {what} would grow from {size / 1e6:.3g} MB to {expanded_bytes / 1e6:.3g} MB, "
            f"expected at most {MOST_TIMES} times as much or {ALWAYS_BYTES / 1e6:.0f} MB"
        )
