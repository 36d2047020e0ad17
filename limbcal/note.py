"""A note: one thing that a person should know of data or of an answer, in a form that programs read too."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

#: Sources with the same sentence that are named one by one.
_NAMED = 3


@dataclass(frozen=True)
class Note:
    """What was found, where, what causes it most likely, and what was done about it.

    Attributes
    ----------
    kind : str
        One word for programs, such as ``unit``, ``turn``, ``saturated``; a kind means the same in every command.
    text : str
        One sentence for a person: what was seen, its likely cause, what was done.
    source : str
        The file, recording or trial; empty where the note is of the whole answer.
    columns : tuple of str
        Columns of a table, or markers, that it is about.
    row : int, optional
        First data row, counted from 1.
    from_s, to_s : float, optional
        Where on the source's own time [s]; None for all of it.
    """

    kind: str
    text: str
    source: str = ""
    columns: tuple[str, ...] = ()
    row: int | None = None
    from_s: float | None = None
    to_s: float | None = None

    @property
    def sentence(self) -> str:
        """The text with its source before it, as it stands at a terminal."""
        return f"{self.source}: {self.text}" if self.source else self.text

    def document(self) -> dict[str, object]:
        """Return the JSON document of the note; ``markers`` is what its columns are called of optical markers."""
        return {
            "kind": self.kind,
            "source": self.source,
            "columns": list(self.columns),
            "markers": list(self.columns),
            "row": self.row,
            "from_s": self.from_s,
            "to_s": self.to_s,
            "text": self.text,
        }


def of_source(notes: Iterable[Note], source: str) -> tuple[Note, ...]:
    """Return notes with their source filled in, where they have none yet."""
    return tuple(note if note.source else replace(note, source=source) for note in notes)


def documents(notes: Iterable[Note]) -> list[dict[str, object]]:
    """Return the ``notes`` of a command's JSON document: each once, in their order."""
    return [note.document() for note in dict.fromkeys(notes)]


def sentences(notes: Iterable[Note]) -> list[str]:
    """Return what to say of notes: each sentence once, with the sources that share it named together."""
    sources: dict[str, list[Note]] = {}
    for note in dict.fromkeys(notes):
        sources.setdefault(note.text, []).append(note)
    return [_said(text, alike) for text, alike in sources.items()]


def _said(text: str, alike: list[Note]) -> str:
    rows = {note.row for note in alike}
    row = rows.pop() if len(rows) == 1 else None
    where = "" if row is None or f"row {row}" in text else f" (the first in row {row})"
    names = [note.source for note in alike]
    return f"{_listed(names)}: {text}{where}" if any(names) else f"{text}{where}"


def _listed(names: list[str]) -> str:
    if len(names) <= _NAMED:
        return ", ".join(names)
    return f"{', '.join(names[: _NAMED - 1])} and {len(names) - _NAMED + 1} more"
