"""What the switches of drives must be like."""

import numpy as np

from limbcal.errors import DataError
from protocol.tables.table import Floats


def require_switches(on: Floats, where: str, first_row: int = 0) -> None:
    """Raise a DataError that names the row (from 1) where a drive is neither engaged (1) nor let go (0)."""
    wrong = (on != 0.0) & (on != 1.0)
    if wrong.any():
        row, joint = (int(place[0]) for place in np.nonzero(wrong))
        raise DataError(
            f"{where}: on{joint + 1} in row {first_row + row + 1} is {on[row, joint]:g}, expected 1 where the "
            "drive is engaged and 0 where it is let go"
        )
