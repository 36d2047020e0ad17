"""What is known of a push while a joint rests: all but the friction that holds the joint."""

from dataclasses import replace

import numpy as np

from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Background, Rows
from fitter.diagnosis.torque.kalman import Filter


def with_rests(rows: Rows) -> Rows:
    """Return rows of which those at rest are known, too."""
    return replace(rows, known=rows.known | rows.at_rest)


def filtered_with_rests(background: Background, rows: Rows) -> Filter:
    """Return the filter of rows of which those at rest are known, too, but for what holds the joint.

    Friction at rest is uniform between its limits. It changes slowly, with the arm's load, and at once where the
    joint is about to move or is pushed: a further signal of eq. (m.1), and white noise, each with that variance.
    """
    held = np.where(rows.at_rest, rows.friction, 0.0)
    wider = replace(
        background,
        in_proportion=np.append(background.in_proportion, 1.0 / np.sqrt(3.0)),
        proportion_s=np.append(background.proportion_s, LONGEST_PULSE_S),
    )
    return wider.filtered(replace(with_rests(rows), signals=np.column_stack([rows.signals, held])))


def unseen(rows: Rows, at_s: float, way: int) -> tuple[float, float]:
    """Return from when to when [s] nothing tells whether a push acts, about its start (-1) or its end (1).

    Both are that instant if its row tells and the one beside it.
    """
    k = int(np.clip(np.searchsorted(rows.t, at_s + 0.5 * rows.step_s) - 1, 0, len(rows.t) - 1))
    tells = np.concatenate([[True], rows.known, [True]])
    near = k + 1 if not tells[k + 1] else k + 1 + way
    if tells[near]:
        return at_s, at_s
    last, next_ = near - int(np.argmax(tells[near::-1])), near + int(np.argmax(tells[near:]))
    half_s = 0.5 * rows.step_s
    return float(rows.t[last]) - half_s, float(rows.t[next_ - 2]) + half_s


def amid(rows: Rows, start_s: float, duration_s: float) -> tuple[float, float, float, float]:
    """Return start and duration [s] of a push whose ends are amid what is unseen of each, and how long that lasts.

    Unchanged if it would be over.
    """
    ends_s = start_s + duration_s
    first, last = unseen(rows, start_s, -1), unseen(rows, ends_s, 1)
    # What lasts longer is no pulse.
    first = min(max(first[0], ends_s - LONGEST_PULSE_S), first[1]), first[1]
    last = last[0], max(min(last[1], start_s + LONGEST_PULSE_S), last[0])
    begin_s, end_s = 0.5 * sum(first), 0.5 * sum(last)
    if end_s > begin_s:
        start_s, duration_s = begin_s, end_s - begin_s
    return start_s, duration_s, first[1] - first[0], last[1] - last[0]
