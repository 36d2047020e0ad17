"""Cutting a stream of pieces of any length into blocks of one length."""

from collections.abc import Callable, Sequence
from typing import Generic, Protocol, TypeVar


class Piece(Protocol):
    """Some rows in a row; ``gap`` says that rows are missing before the first."""

    @property
    def n(self) -> int:
        """Number of rows."""

    @property
    def gap(self) -> bool:
        """Whether rows are missing before the first."""


T = TypeVar("T", bound=Piece)


class BlockCutter(Generic[T]):
    """Gathers pieces and gives out blocks of ``size`` rows; a block ends early where a gap follows.

    Parameters
    ----------
    size : int
    join : callable
        Makes one piece of several that follow each other.
    cut : callable
        ``cut(piece, begin, end)`` are the rows from ``begin`` up to ``end``.
    """

    def __init__(self, size: int, join: Callable[[Sequence[T]], T], cut: Callable[[T, int, int], T]) -> None:
        self._size = size
        self._join = join
        self._cut = cut
        self._pending: list[T] = []

    def add(self, piece: T) -> list[T]:
        """Take a piece; return the blocks that it completes."""
        blocks = self.flush() if piece.gap else []
        self._pending.append(piece)
        if sum(p.n for p in self._pending) < self._size:
            return blocks
        whole = self._join(self._pending)
        full = whole.n - whole.n % self._size
        blocks += [self._cut(whole, i, i + self._size) for i in range(0, full, self._size)]
        self._pending = [self._cut(whole, full, whole.n)] if full < whole.n else []
        return blocks

    def flush(self) -> list[T]:
        """Return what is pending as a block of its own."""
        blocks = [self._join(self._pending)] if self._pending else []
        self._pending = []
        return blocks
