"""Files named on the command line: a folder stands for the files in it, in name order."""

from collections.abc import Sequence
from pathlib import Path

from fitter.data.nested import NestedFile
from fitter.data.tables import Source, TableFile
from limbcal.errors import DataError

TABLES = (".csv", ".parquet")
NESTED = (".npz", ".mat", ".json")
RECORDINGS = (".mcap",)
SUFFIXES = (*TABLES, *NESTED, *RECORDINGS)


def expand(sources: Sequence[Path]) -> list[Path]:
    """Return the data files that some files and folders stand for.

    Parameters
    ----------
    sources : sequence of Path
        Files are taken in the order given; a folder gives the data files directly in it, in name order.

    Raises
    ------
    DataError
        If a source does not exist, is of an unknown format, or is a folder without data files.
    """
    files: list[Path] = []
    for source in sources:
        path = Path(source)
        if path.is_dir():
            inside = sorted(file for file in path.iterdir() if file.suffix.lower() in SUFFIXES)
            if not inside:
                raise DataError(f"{path}: no data file in this folder, expected {', '.join(SUFFIXES)}")
            files += inside
        elif not path.exists():
            raise DataError(f"{path}: there is no such file or folder")
        elif path.suffix.lower() not in SUFFIXES:
            raise DataError(f"{path}: the suffix is {path.suffix!r}, expected one of {', '.join(SUFFIXES)}")
        else:
            files.append(path)
    if not files:
        raise DataError("no data was named, expected at least one file or folder")
    return files


def open_source(path: Path) -> Source:
    """Open a file of columns, whatever its format."""
    return TableFile(path) if path.suffix.lower() in TABLES else NestedFile(path)
