"""Files named on the command line: a folder stands for the files in it, in name order."""

from collections.abc import Sequence
from pathlib import Path

from limbcal.errors import DataError
from protocol.tables.csv_file import CsvFile
from protocol.tables.nested import NestedFile
from protocol.tables.npz_file import NpzFile
from protocol.tables.parquet_file import ParquetFile
from protocol.tables.source import Source

TABLES = (".csv", ".tsv", ".parquet", ".npz", ".mat", ".json", ".jsonl", ".ndjson")
RECORDINGS = (".mcap",)
SUFFIXES = (*TABLES, *RECORDINGS)


def expand(sources: Sequence[Path]) -> list[Path]:
    """Return the data files that some files and folders stand for.

    Parameters
    ----------
    sources : sequence of Path
        Files are taken in the order given; a folder gives the data files directly in it, in name order.

    Raises
    ------
    DataError
        If a source does not exist, is of an unknown format, or is a folder without data files; or if a file is
        named twice: its trials would count twice, and make what is learnt of them look surer than it is.
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
    seen: set[Path] = set()
    for file in files:
        if file.resolve() in seen:
            raise DataError(f"{file} is named twice, or itself and with its folder; expected each file once")
        seen.add(file.resolve())
    return files


def open_source(path: Path) -> Source:
    """Open a file of columns, whatever its format.

    Raises
    ------
    DataError
        If there is no such file, it is of another format, or cannot be read.
    """
    suffix = path.suffix.lower()
    if suffix not in TABLES:
        raise DataError(f"{path}: the suffix is {path.suffix!r}, expected one of {', '.join(TABLES)}")
    if suffix in (".csv", ".tsv"):
        return CsvFile(path)
    if suffix == ".parquet":
        return ParquetFile(path)
    return NpzFile(path) if suffix == ".npz" else NestedFile(path)
