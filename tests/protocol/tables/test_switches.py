"""A drive is engaged or let go."""

import numpy as np
import pytest

from limbcal.errors import DataError
from protocol.tables.switches import require_switches


def test_engaged_and_let_go_are_what_a_switch_can_say() -> None:
    require_switches(np.array([[1.0, 0.0], [0.0, 1.0]]), "run.csv")


@pytest.mark.parametrize(
    ("on", "words"),
    [
        ([[1, 2], [0, 1]], "on2 in row 8 is 2, expected 1"),
        ([[1, 0], [-1, 0.5]], "on1 in row 9 is -1, expected 1"),
        (
            [[1, 0], [0, 0.5]],
            "on2 in row 9 is 0.5, expected 1 where the drive is engaged and 0 where it is let go",
        ),
    ],
)
def test_anything_else_is_refused_with_its_row(on: list[list[float]], words: str) -> None:
    with pytest.raises(DataError, match=f"run.csv: {words}"):
        require_switches(np.array(on, dtype=float), "run.csv", 7)
