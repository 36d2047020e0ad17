"""What the residuals of the neighbouring joints say about one joint's.

A stand or a transmission that vibrates, and noise of an angle that was differentiated twice, act in the torque
equations of several joints at once: their residuals are coherent towards the band's end. A push acts in the
equation of its own joint alone. So the fast part of a neighbour's residual is a signal in proportion to which the
model may err, eq. (m.1). The second difference of the rows has it: it passes the band's upper half.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from arm.model import Floats
from fitter.diagnosis.torque.background import Rows
from fitter.diagnosis.torque.pulse import Pulse, without


def neighbours(joint: int, n_joint: int) -> list[int]:
    """Return the joints at the other ends of a joint's links."""
    return [k for k in (joint - 1, joint + 1) if 0 <= k < n_joint]


def beside_neighbours(joints: Sequence[Sequence[Rows]], joint: int, pulses: Sequence[Pulse]) -> list[Rows]:
    """Return one joint's rows, with the fast part of its neighbours' residuals as further signals.

    Parameters
    ----------
    joints : sequence of sequence of Rows
        Of every joint, of every trial.
    joint : int
    pulses : sequence of Pulse
        Pushes at any joint: those of a neighbour are no vibration, and are taken out.

    Returns
    -------
    list of Rows
        Of every trial. Where a neighbour's residual is not known its signal is 0.
    """
    signals = [
        [_fast_part(rows) for rows in without(joints[k], [pulse for pulse in pulses if pulse.joint == k])]
        for k in neighbours(joint, len(joints))
    ]
    return [
        replace(rows, signals=np.column_stack([rows.signals, *(of_trials[k] for of_trials in signals)]))
        for k, rows in enumerate(joints[joint])
    ]


def _fast_part(rows: Rows) -> Floats:
    """Return the second difference of a residual, (n,), 0 where one of its three rows is not known."""
    curved = np.zeros(len(rows.r))
    known = rows.known[:-2] & rows.known[1:-1] & rows.known[2:]
    curved[1:-1][known] = (rows.r[:-2] - 2.0 * rows.r[1:-1] + rows.r[2:])[known]
    return curved
