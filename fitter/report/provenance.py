"""Where an answer comes from: the command, its files, the version, the day."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from limbcal.arguments import version
from limbcal.command import command_line


@dataclass(frozen=True)
class Provenance:
    """What is needed to make an answer again.

    Attributes
    ----------
    command : str
        As it was typed.
    date : str
        ISO 8601, with the zone's offset.
    version : str
        Of limbcal.
    files : tuple of str
        What was read.
    """

    command: str
    date: str
    version: str
    files: tuple[str, ...] = ()

    def rows(self) -> list[tuple[str, str]]:
        """Return name and value of everything that is known."""
        rows = [("date", self.date), ("limbcal", self.version), ("command", self.command)]
        rows += [("files" if k == 0 else "", file) for k, file in enumerate(self.files)]
        return [row for row in rows if row[1]]


def provenance(files: Sequence[object] = ()) -> Provenance:
    """Return where an answer of the command that is being carried out comes from.

    Parameters
    ----------
    files : sequence of path or str
        What it read.
    """
    date = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
    return Provenance(command_line(), date, version(), tuple(str(file) for file in files))
