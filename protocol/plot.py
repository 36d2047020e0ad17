"""`limb/plot`: joint and tip motion as flat rows, which is what plotting programs read."""

from collections.abc import Mapping
from itertools import chain
from typing import Any

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
    picked = range(-motion["frame0"] % step, motion["n"], step)
    if not picked:
        return []
    names, parts = ["ts"], [[[(motion["t0_ns"] + round(i * motion["dt_s"] * 1e9)) / 1e9] for i in picked]]
    for signal in (*_BY_JOINT, "tip"):
        if motion.get(signal) is not None:
            values = motion[signal][picked.start :: step].tolist()
            names += (f"{signal}{end}" for end in ("xyz" if signal == "tip" else range(1, len(values[0]) + 1)))
            parts.append(values)
    return [dict(zip(names, chain.from_iterable(row), strict=True)) for row in zip(*parts, strict=True)]


def plot_step(dt_s: float) -> int:
    """Return every how manieth frame is a row, so that they are 100 a second at the most."""
    return max(1, round(1.0 / (PLOT_HZ * dt_s)))
