"""Text of marker and force tables: in any encoding, with decimal points or commas."""

from pathlib import Path

from protocol.tables.dialect import HEAD_BYTES, encoding_of


def text_of(path: Path) -> str:
    """Return the text of a file, in the encoding that its first bytes show.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    data = path.read_bytes()
    return data.decode(encoding_of(data[:HEAD_BYTES]), errors="replace")


def number_of(text: str) -> float:
    """Return a number with a decimal point or a decimal comma; cells are separated by other than commas.

    Raises
    ------
    ValueError
        If it is none.
    """
    return float(text if "." in text else text.replace(",", "."))
