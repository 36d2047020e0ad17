"""`limb/plot`: joint and tip motion as flat rows, which is what plotting programs read."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

PLOT_HZ = 100.0
#: Signals by joint, where there are such.
_BY_JOINT = ("q", "dq", "ddq", "q_std")


def plot_rows(motion: Mapping[str, Any], step: int) -> list[dict[str, float]]:
    """Return every ``step``-th frame of a block as a row, by its number since the motion began.

    Parameters
    ----------
    motion : mapping
        Fields of `limb/frames` or `limb/play`: ``frame0, t0_ns, dt_s, n``, ``q, dq, ddq`` and perhaps ``q_std``
        (n, n_joint), ``tip`` (n, 3).
    step : int

    Returns
    -------
    list of dict
        Each with ``ts`` [s, UTC], ``q1…``, ``dq1…``, ``ddq1…``, ``tipx``, ``tipy``, ``tipz``.
    """
    columns: dict[str, NDArray[np.float64]] = {}
    for name in _BY_JOINT:
        if motion.get(name) is not None:
            values = motion[name]
            columns.update({f"{name}{j + 1}": values[:, j] for j in range(values.shape[1])})
    columns.update({f"tip{axis}": motion["tip"][:, k] for k, axis in enumerate("xyz")})
    first = -motion["frame0"] % step
    return [
        {
            "ts": (motion["t0_ns"] + round(i * motion["dt_s"] * 1e9)) / 1e9,
            **{name: float(values[i]) for name, values in columns.items()},
        }
        for i in range(first, motion["n"], step)
    ]


def plot_step(dt_s: float) -> int:
    """Return every how manieth frame is a row, so that they are 100 a second at the most."""
    return max(1, round(1.0 / (PLOT_HZ * dt_s)))
