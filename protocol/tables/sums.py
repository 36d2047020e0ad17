"""Sums of columns in a mapping: ``Y[2]-Y[1]``, ``tau{j}-pulse{j}``, ``-angle+pi``, ``gain/800``, or one number."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from protocol.tables.table import Floats

_SPACE = re.compile(r"\s*")
_NUMBER = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?=\s*(?:[-+*/]|$))")
#: What stands in brackets belongs to the name, whatever it is.
_NAME = re.compile(r"(?:[^-+*/()\[\]]|\([^)]*\)|\[[^\]]*\])+")
_PI = "pi"


@dataclass(frozen=True)
class ColumnSum:
    """Columns times factors, and a constant.

    Attributes
    ----------
    terms : tuple of (str, float)
        Names of columns with their factors, in the order written; none where it is a number alone.
    constant : float
        In the unit of the sum.
    """

    terms: tuple[tuple[str, float], ...] = ()
    constant: float = 0.0

    @property
    def is_plain(self) -> bool:
        """Whether it is one column as it stands."""
        return self.constant == 0.0 and len(self.terms) == 1 and self.terms[0][1] == 1.0


@dataclass(frozen=True)
class RoleSums:
    """The sums that a role's columns are, over what is read of the file for it.

    Attributes
    ----------
    matrix : ndarray of shape (n_column, n_read)
    constant : ndarray of shape (n_column,)
    """

    matrix: Floats
    constant: Floats

    def of(self, read: Floats) -> Floats:
        """Return the role's columns, (n_row, n_column), of what was read, (n_row, n_read), in SI."""
        return np.asarray(read @ self.matrix.T + self.constant, dtype=np.float64)


def role_sums(sums: Sequence[ColumnSum]) -> RoleSums:
    """Return the sums of a role for columns that are read in the order of their terms."""
    matrix = np.zeros((len(sums), sum(len(one.terms) for one in sums)))
    place = 0
    for row, one in enumerate(sums):
        for _, factor in one.terms:
            matrix[row, place] = factor
            place += 1
    return RoleSums(matrix, np.array([one.constant for one in sums]))


def parse_sum(text: str) -> ColumnSum | None:
    """Return the sum that a text writes, or None if it writes none.

    A term is a number (``pi`` is one), a column, or a column times or divided by numbers.
    """
    terms: list[tuple[str, float]] = []
    constant, place, sign = 0.0, _past_space(text, 0), 1.0
    while True:
        while place < len(text) and text[place] in "+-":
            sign = -sign if text[place] == "-" else sign
            place = _past_space(text, place + 1)
        found = _product(text, place)
        if found is None:
            return None
        name, factor, place = found
        if name:
            terms.append((name, sign * factor))
        else:
            constant += sign * factor
        if place == len(text):
            return ColumnSum(tuple(terms), constant)
        sign = 1.0  # the loop above reads the operator that stands here


def _product(text: str, place: int) -> tuple[str, float, int] | None:
    """Return the column (or nothing) and the factor of a product, and the place of the sign after it."""
    name, factor, operator = "", 1.0, "*"
    while True:
        number, column = _NUMBER.match(text, place), _NAME.match(text, place)
        if number is None and column is None:
            return None
        found = number or column
        assert found is not None
        place = _past_space(text, found.end())
        word = found[0].strip()
        if number is not None or word == _PI:
            value = math.pi if number is None else float(word)
            if operator == "/" and value == 0.0:
                return None
            factor = factor * value if operator == "*" else factor / value
        elif name or operator == "/" or not word:
            return None  # a product or quotient of columns is no sum
        else:
            name = word
        if place == len(text) or text[place] in "+-":
            return name, factor, place
        if text[place] not in "*/":
            return None
        operator, place = text[place], _past_space(text, place + 1)


def _past_space(text: str, place: int) -> int:
    space = _SPACE.match(text, place)
    assert space is not None
    return space.end()
