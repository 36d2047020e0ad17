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
    try:
        neighbours = list(path.parent.iterdir())
    except OSError:
        neighbours = []
    first = _first_of(path, neighbours)
    found = {1: first} if first.is_file() else {}
    for neighbour in neighbours:
        number = _number_after(first, neighbour)
        if number is not None:
            found[number] = neighbour
    return [found[number] for number in sorted(found)]


def _first_of(path: Path, neighbours: list[Path]) -> Path:
    """Return the first file of a recording; one that others go on from is that, whatever it is called."""
    number = _NUMBER.search(path.stem)
    if number is None or any(_number_after(path, neighbour) for neighbour in neighbours):
        return path
    first = path.with_stem(path.stem.removesuffix(number[0]))
    return path if _number_after(first, path) is None else first


def _number_after(first: Path, path: Path) -> int | None:
    """Return the number of a further file of a recording; None if it is none of them."""
    found = _NUMBER.search(path.stem)
    number = 1 if found is None else int(found[1])
    return number if number > 1 and path == numbered(first, number) else None
