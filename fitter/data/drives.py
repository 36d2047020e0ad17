"""The columns of the drives: whether they are engaged, and gains of a trial's own."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from arm.drive_state import DriveState
from limbcal.note import Note
from protocol.tables.columns import DRIVE_ROLES

Floats = NDArray[np.float64]


def drives_of(columns: Mapping[str, Floats]) -> DriveState | None:
    """Return the state of the drives that some columns say; None where they say no more than ``[control]`` does.

    Parameters
    ----------
    columns : mapping of str to ndarray of shape (n_sample, n_joint)
        By role; ``on``, ``kp`` and ``kv`` count, where there are any.
    """
    on, kp, kv = (columns.get(role) for role in DRIVE_ROLES)
    if kp is None and kv is None and (on is None or bool(on.all())):
        return None
    shape = next(values.shape for values in (on, kp, kv) if values is not None)
    return DriveState(np.ones(shape, dtype=np.bool_) if on is None else on > 0.5, kp, kv)


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
