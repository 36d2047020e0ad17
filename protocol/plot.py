"""`limb/plot`: joint and tip motion as flat rows, which is what plotting programs read."""

import math
from collections.abc import Mapping
from functools import cache
from typing import Any

#: Frames a second that `limb/plot` has [Hz]: as many as a screen can show.
PLOT_HZ = 100.0
#: Rates are measured, and a thousand a second may be called a little more: ten times what a crystal is off by.
_MEASURED = 1e-3
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
    picked = range(-motion["frame0"] % step, motion["n"], step)
    if not picked:
        return []
    signals = [name for name in (*_BY_JOINT, "tip") if motion.get(name) is not None]
    names = _columns(motion["q"].shape[1], *signals)
    t0_ns, dt_s, arrays = motion["t0_ns"], motion["dt_s"], [motion[name] for name in signals]
    rows = []
    for i in picked:
        values = [(t0_ns + round(i * dt_s * 1e9)) / 1e9]
        for array in arrays:
            values += array[i].tolist()
        rows.append(dict(zip(names, values, strict=True)))
    return rows


def plot_row_count(frame0: int, n: int, dt_s: float) -> int:
    """Return how many rows `plot_rows` makes of a block: frames from number ``frame0`` on, n of them."""
    return len(range(-frame0 % (step := plot_step(dt_s)), n, step))


@cache
def _columns(n_joint: int, *signals: str) -> list[str]:
    """Return what the values of a row are called."""
    of_joints = [f"{signal}{j}" for signal in signals if signal != "tip" for j in range(1, n_joint + 1)]
    return ["ts", *of_joints, *(f"tip{axis}" for axis in "xyz" if "tip" in signals)]


def plot_step(dt_s: float) -> int:
    """Return every how manieth frame is a row, so that they are 100 a second at the most."""
    return max(1, math.ceil((1.0 - _MEASURED) / (PLOT_HZ * dt_s)))
