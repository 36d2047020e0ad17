"""Endurance: at length in ``make soak``, shortened in ``make test``."""

from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")


class Long:
    """How long a test of endurance is to be, and where its figures go."""

    def __init__(self, at_length: bool, note: Callable[[str], None], minutes: float = 30.0) -> None:
        self.at_length = at_length
        self.note = note
        self.minutes = minutes

    def of(self, at_length: T, shortened: T) -> T:
        """Return what this run is to take."""
        return at_length if self.at_length else shortened
