"""The log evidence of pulses: what they gain over the background, less what their places and sizes cost."""

from collections.abc import Sequence

import numpy as np

from fitter.diagnosis.torque.background import Background, Rows, log_likelihood
from fitter.diagnosis.torque.background_fit import estimated
from fitter.diagnosis.torque.pulse import Pulse, Shapes, without
from fitter.diagnosis.torque.residual_torque import ResidualTorque, rows_by_joint


def residual_log_evidence(trials: Sequence[ResidualTorque], pulses: Sequence[Pulse]) -> float:
    """Return the log evidence of a residual: some pulses and the likeliest background of each joint [nats].

    Parameters
    ----------
    trials : sequence of ResidualTorque
    pulses : sequence of Pulse
        As they were found in these trials.
    """
    joints, total = rows_by_joint(trials), 0.0
    for joint, rows in enumerate(joints):
        own = [one for one in pulses if one.joint == joint]
        remaining = without(rows, own)
        total += log_likelihood(estimated(remaining), remaining) - cost(own, count_places(rows, len(joints)))
    return total


def cost(pulses: Sequence[Pulse], n_place: int) -> float:
    """Return what the places of some pulses and the priors of their sizes cost [nats]."""
    sized = sum(pulse.log_likelihood_ratio - pulse.evidence for pulse in pulses)
    return float(sized + sum(log_places(n_place, k + 1) for k in range(len(pulses))))


def count_places(rows: Sequence[Rows], n_joint: int) -> int:
    """Return at how many places a pulse may be."""
    return n_joint * sum(int(np.count_nonzero(Shapes.of(part).fit(part))) for part in rows)


def log_places(n_place: int, k: int) -> float:
    """Return how many more sets of places there are for k pulses than for one fewer, as a logarithm.

    All sets of k pulses are equally likely beforehand, and that there are k of them with 1 / (k (k + 1)).
    """
    if k == 0:
        return 0.0
    more = (k + 1.0) / (k - 1.0) if k > 1 else 2.0
    return float(np.log(max(n_place - k + 1, k) / k * more))


def log_evidence(
    rows: Sequence[Rows], pulses: Sequence[Pulse], one: Pulse, background: Background, anew: bool
) -> float:
    """Return the log evidence of one of some pulses, without the number of its places [nats].

    Parameters
    ----------
    rows : sequence of Rows
    pulses : sequence of Pulse
    one : Pulse
    background : Background
        The likeliest without all of them.
    anew : bool
        Whether it is held against the likeliest without the others.
    """
    alone = without(rows, [pulse for pulse in pulses if pulse is not one])
    holding = estimated(alone, background) if anew else background
    gain = log_likelihood(background, without(rows, pulses)) - log_likelihood(holding, alone)
    return gain + one.evidence - one.log_likelihood_ratio
