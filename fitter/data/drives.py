"""What the column of a drive that is let go makes of its torque."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from limbcal.note import Note

Floats = NDArray[np.float64]


def let_go(columns: Mapping[str, Floats], where: str) -> tuple[dict[str, Floats], tuple[Note, ...]]:
    """Return columns whose torque is zero wherever the drive is not engaged, and what there is to say of that."""
    found, on = dict(columns), columns.get("on")
    if on is None or "tau" not in found:
        return found, ()
    off = on < 0.5
    found["tau"] = np.where(off, 0.0, found["tau"])
    notes = [
        Note(
            "let_go",
            f"the drive of joint {j + 1} is let go in {int(off[:, j].sum())} of {len(off)} samples: its torque, "
            f"up to {float(np.abs(columns['tau'][off[:, j], j]).max()):.3g} there, counts as 0",
            source=where,
            columns=(f"on{j + 1}", f"tau{j + 1}"),
        )
        for j in np.flatnonzero(off.any(axis=0)).tolist()
    ]
    return found, tuple(notes)
