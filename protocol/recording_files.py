"""The files of one recording: the first, and those that go on where one was full or its disk failed."""

import re
from pathlib import Path

#: A first file ends with eight digits of its run, which may all be decimal.
_NUMBER = re.compile(r"-(\d{3,7})$")


def numbered(path: Path, number: int) -> Path:
    """Return what a further file of a recording is called, from its first file and the number, from 2 on."""
    return path.with_stem(f"{path.stem}-{number:03d}")


def number_of(path: Path) -> int:
    """Return which file of its recording one is, from 1."""
    number = _NUMBER.search(path.stem)
    return 1 if number is None else int(number[1])


def files_of(path: Path) -> list[Path]:
    """Return the files of a recording that are there, in the order in which they were written.

    Parameters
    ----------
    path : Path
        Any of them.

    Returns
    -------
    list of Path
        Empty where none is there, or their folder cannot be read.
    """
    first = path.with_stem(_NUMBER.sub("", path.stem))
    found: dict[int, Path] = {1: first} if first.is_file() else {}
    try:
        neighbours = list(first.parent.iterdir())
    except OSError:
        return list(found.values())
    for neighbour in neighbours:
        number = _NUMBER.search(neighbour.stem)
        if number is not None and neighbour == numbered(first, int(number[1])):
            found[int(number[1])] = neighbour
    return [found[number] for number in sorted(found)]
