"""Pulses that were found in one residual, where they are likeliest in another: that of a model beside them."""

from collections.abc import Mapping, Sequence

from fitter.diagnosis.least_squares import ITERATIONS, NEGLIGIBLE
from fitter.diagnosis.torque.background import Background, Rows, rms
from fitter.diagnosis.torque.background_fit import estimated
from fitter.diagnosis.torque.neighbours import beside_neighbours
from fitter.diagnosis.torque.pulse import Pulse, without
from fitter.diagnosis.torque.pulse_evidence import count_places, log_evidence, log_places
from fitter.diagnosis.torque.pulse_search import Search
from fitter.diagnosis.torque.residual_torque import ResidualTorque, rows_by_joint


def at_likeliest(trials: Sequence[ResidualTorque], pulses: Sequence[Pulse]) -> list[Pulse]:
    """Return pulses at their likeliest places and sizes, beside the background that is likeliest without all.

    Parameters
    ----------
    trials : sequence of ResidualTorque
        Of a model without any of them.
    pulses : sequence of Pulse
        Near to where they are.
    """
    joints = rows_by_joint(trials)
    now, backgrounds = list(pulses), _backgrounds(joints, pulses, {})
    for _ in range(ITERATIONS):
        before, now = now, _moved(joints, now, backgrounds)
        off = [abs(a.impulse - b.impulse) / b.impulse_std for a, b in zip(before, now, strict=True)]
        if max(off, default=0.0) < NEGLIGIBLE:
            break
        backgrounds = _backgrounds(joints, now, backgrounds)
    return now


def still_likely(trials: Sequence[ResidualTorque], pulses: Sequence[Pulse]) -> list[Pulse]:
    """Return those of some pulses that are likelier than not, at their likeliest places.

    They are beside one another: the least evident one goes until all are.

    Parameters
    ----------
    trials : sequence of ResidualTorque
        Of a model without any of them.
    pulses : sequence of Pulse
        Near to where they would be.
    """
    joints, kept = rows_by_joint(trials), list(pulses)
    backgrounds = _backgrounds(joints, kept, {})
    while kept:
        kept = _moved(joints, kept, backgrounds)
        odds = [_log_odds(joints, kept, one, backgrounds[one.joint]) for one in kept]
        if min(odds) > 0.0:
            break
        del kept[odds.index(min(odds))]
        backgrounds = _backgrounds(joints, kept, backgrounds)
    return kept


def _of_joint(
    joints: Sequence[Sequence[Rows]], joint: int, pulses: Sequence[Pulse]
) -> tuple[list[Rows], list[Pulse]]:
    """Return one joint's rows with its neighbours' signals, and its own pulses."""
    return beside_neighbours(joints, joint, pulses), [one for one in pulses if one.joint == joint]


def _backgrounds(
    joints: Sequence[Sequence[Rows]], pulses: Sequence[Pulse], near: Mapping[int, Background]
) -> dict[int, Background]:
    """Return the likeliest background of each joint that is pushed, near to another one if that is known."""
    found = {}
    for joint in {one.joint for one in pulses}:
        rows, own = _of_joint(joints, joint, pulses)
        found[joint] = estimated(without(rows, own), near.get(joint))
    return found


def _moved(
    joints: Sequence[Sequence[Rows]], pulses: Sequence[Pulse], backgrounds: Mapping[int, Background]
) -> list[Pulse]:
    """Return pulses of which each was moved to its likeliest place beside the others."""
    now = list(pulses)
    for place, one in enumerate(pulses):
        now[place] = _beside_others(joints, now, one, backgrounds[one.joint])
    return now


def _beside_others(
    joints: Sequence[Sequence[Rows]], pulses: Sequence[Pulse], one: Pulse, background: Background
) -> Pulse:
    """Return one of some pulses at its likeliest place, the others where they are."""
    rows, own = _of_joint(joints, one.joint, pulses)
    alone = without(rows, [pulse for pulse in own if pulse is not one])[one.trial]
    return Search(one.trial, one.joint, alone, background, rms(rows)).again(one)


def _log_odds(
    joints: Sequence[Sequence[Rows]], pulses: Sequence[Pulse], one: Pulse, background: Background
) -> float:
    """Return the logarithm of the odds that one of some pulses is there [nats]."""
    rows, own = _of_joint(joints, one.joint, pulses)
    places = log_places(count_places(rows, len(joints)), len(own))
    return log_evidence(rows, own, one, background, anew=False) - places
