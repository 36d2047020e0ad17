"""What an experiment of the paper's is handed, and what it hands back: tables, pictures and plain statements."""

from collections.abc import Callable
from dataclasses import dataclass, field

from matplotlib.figure import Figure

Cell = str | float | None
Document = dict[str, object]


def silent(_message: str) -> None:
    """Say nothing."""


@dataclass(frozen=True)
class Settings:
    """What an experiment is run with.

    Attributes
    ----------
    seed : int
        Same seed, same bytes.
    samples : int or None
        Number of samples where an experiment has one of its own; None takes the paper's.
    quick : bool
        A small version, for tests: the same steps on less data.
    progress : callable
        Told in a few words what is being done.
    """

    seed: int = 0
    samples: int | None = None
    quick: bool = False
    progress: Callable[[str], None] = silent


@dataclass(frozen=True)
class Grid:
    """A table: a title, a header and rows as wide as it; None is an empty cell.

    Raises
    ------
    ValueError
        If a row is not as wide as the header.
    """

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def __post_init__(self) -> None:
        widths = {len(row) for row in self.rows} - {len(self.header)}
        if widths:
            raise ValueError(f"{self.title}: rows have {sorted(widths)} cells, expected {len(self.header)}")


@dataclass(frozen=True)
class Picture:
    """A figure and what is to be seen in it."""

    figure: Figure
    caption: str


@dataclass(frozen=True)
class Experiment:
    """What came of one of the paper's experiments.

    Attributes
    ----------
    name : str
        As on the command line, such as "table1".
    title : str
    assumptions : tuple of str
        What the paper leaves open, and how it was settled here.
    grids : tuple of Grid
    pictures : tuple of Picture
    findings : tuple of str
        What the tables show, one sentence each.
    document : dict
        The same figures for JSON.
    """

    name: str
    title: str
    assumptions: tuple[str, ...] = ()
    grids: tuple[Grid, ...] = ()
    pictures: tuple[Picture, ...] = ()
    findings: tuple[str, ...] = ()
    document: Document = field(default_factory=dict)
