"""Pulses: torques of some duration that stand in no column, found in the residual of the torque equation.

A pulse is sought at every instant with every duration, by its evidence against the coloured background with
Student's tails (`background`): the likelihood ratio integrated over a prior of its size, with all places equally
likely beforehand. Whatever the background's tails, it exceeds odds of a hundred to one by chance no more often
than once in a hundred searches (Markov's inequality: its mean under the background is one). What the background
does not follow is estimated from the evidence in blocks without a pulse (`Tail`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import scipy

from arm.model import Floats
from fitter.diagnosis.least_squares import EQUAL_SIGMAS, ITERATIONS, NEGLIGIBLE, ODDS_NATS, ROUNDED
from fitter.diagnosis.torque.background import LONGEST_PULSE_S, Background, Rows, log_likelihood, rms
from fitter.diagnosis.torque.background_fit import estimated
from fitter.diagnosis.torque.neighbours import beside_neighbours, neighbours
from fitter.diagnosis.torque.pulse import Pulse, are_same, without
from fitter.diagnosis.torque.pulse_evidence import cost, count_places, log_evidence, log_places
from fitter.diagnosis.torque.pulse_search import Search
from fitter.diagnosis.torque.residual_torque import ResidualTorque, rows_by_joint
from fitter.parallel.forked import side_by_side


@dataclass(frozen=True)
class Tail:
    r"""The tail of the evidence of blocks without a pulse: how evident pulses are by chance.

    Evidence has a longer tail where a background does not follow its model, as where an effect is modelled roughly
    and its errors come in bursts; so that tail is learnt from what no pulse is taken for (an empirical null: Efron
    2004). The excesses over the median are exponential, ``P(E > u + y) = exp(-y / beta) / 2`` (m.3), as those of
    light tails are (Balkema and de Haan 1974).

    Attributes
    ----------
    threshold, scale : float [nats]
        The median u, and beta.
    """

    threshold: float
    scale: float

    @classmethod
    def of(cls, evidence: Floats, most: float, least: float = 1.0) -> "Tail":
        """Return the tail by maximum likelihood.

        Parameters
        ----------
        evidence : (n_block,) [nats]
            Of blocks without a pulse.
        most : float [nats]
            Blocks of more evidence are taken for pulses: the excesses' distribution is cut off there.
        least : float [nats]
            Scale of a background that follows its model, by Markov's inequality.
        """
        if len(evidence) == 0:
            return cls(0.0, least)
        threshold = float(np.median(evidence))
        excess = evidence[evidence > threshold] - threshold
        if len(excess) == 0:
            return cls(threshold, least)
        return cls(threshold, max(least, _scale(float(excess.mean()), most - threshold)))

    def surprisal(self, evidence: float) -> float:
        """Return minus the logarithm of the probability of so evident a block by chance, eq. (m.3)."""
        return float(np.log(2.0) + max(evidence - self.threshold, 0.0) / self.scale)


def _scale(mean: float, most: float) -> float:
    """Return the scale of an exponential distribution that is cut off, by its mean there."""
    if most <= 0.0 or mean >= 0.5 * most:  # as frequent up there as below
        return max(most, mean) / NEGLIGIBLE

    def missing(scale: float) -> float:
        return scale - most / float(np.expm1(most / scale)) - mean

    uncut = mean
    if most > -np.log(ROUNDED) * mean:  # so far out a cut is rounding
        return uncut
    longest = most / NEGLIGIBLE  # as good as flat
    return float(scipy.optimize.brentq(missing, uncut, longest)) if missing(longest) > 0.0 else longest


def find_pulses(trials: Sequence[ResidualTorque], least: float = ODDS_NATS) -> list[Pulse]:
    """Return the pulses in all trials, ordered by trial, joint and start.

    Parameters
    ----------
    trials : sequence of ResidualTorque
    least : float
        Least logarithm of the odds that it is one [nats].

    Returns
    -------
    list of Pulse
    """
    joints = rows_by_joint(trials)
    found, rounds = [list[Pulse]() for _ in joints], [list[Pulse]()]
    due = list(range(len(joints)))
    while due:
        anew = {k: _at_joint(beside_neighbours(joints, k, rounds[-1]), k, len(joints), least) for k in due}
        # A push is no vibration: where others were found, the neighbours are searched anew without them.
        changed = [k for k in due if not are_same(found[k], anew[k])]
        for k in due:
            found[k] = anew[k]
        due = sorted({near for k in changed for near in neighbours(k, len(joints))})
        pulses = [*chain(*found)]
        if any(are_same(one, pulses) for one in rounds):
            break
        rounds.append(pulses)
    return sorted(chain(*found), key=lambda pulse: (pulse.trial, pulse.joint, pulse.start_s))


def _at_joint(rows: Sequence[Rows], joint: int, n_joint: int, odds: float) -> list[Pulse]:
    """Return one joint's pulses, sought by the background of all blocks and by that of the usual ones.

    A large pulse is taken for background by that of all blocks, where lesser ones may be found in its stead. So
    the likelier of both answers is returned. All of its pulses together are likelier than a background without
    any: the least evident ones go until they are.
    """
    whole, n_place = estimated(rows), count_places(rows, n_joint)

    def beside(background: Background) -> tuple[float, list[Pulse]]:
        """Return the pulses found by a background, and the log evidence of all of them [nats]."""
        found, nats = _found_with(background, rows, joint, n_joint, n_place, odds), -np.inf
        while found and (nats := _joint_log_evidence(rows, found, whole, n_place)) <= odds:
            found.remove(min(found, key=lambda pulse: pulse.evidence))
        return (nats, found) if found else (-np.inf, [])

    return max(side_by_side(beside, (whole, _usual(whole, rows))), key=lambda answer: answer[0])[1]


def _joint_log_evidence(rows: Sequence[Rows], pulses: Sequence[Pulse], whole: Background, n_place: int) -> float:
    """Return the log evidence of some pulses against the likeliest background without any [nats]."""
    remaining = without(rows, pulses)
    gain = log_likelihood(estimated(remaining, whole), remaining) - log_likelihood(whole, rows)
    return gain - cost(pulses, n_place)


def _found_with(
    background: Background, rows: Sequence[Rows], joint: int, n_joint: int, n_place: int, odds: float
) -> list[Pulse]:
    """Return one joint's pulses, sought against a background first.

    Pulses that are taken for background hide each other. So all that are likelier than not are taken out, and the
    background is estimated anew, until the same are found again; those with the likeliest background count. Of
    these, those are found that are so likely as any cause must be, each held against the background that is
    likeliest without it.
    """
    size = rms(rows)

    def sought(background: Background, known: int) -> tuple[list[Pulse], Floats, float]:
        """Return the pulses beside some that are known, the evidence of all other blocks, and the least of one."""
        least = log_places(n_place, known + 1)
        searches = [Search(k, joint, part, background, size) for k, part in enumerate(rows)]
        pulses = [pulse for search in searches for pulse in search.found(least)]
        return pulses, np.concatenate([search.evidence_by_block() for search in searches]), least

    rounds = list[tuple[float, list[Pulse], Background]]()
    likely, remaining, least = sought(background, 0)
    while likely and len(rounds) < ITERATIONS and not any(are_same(likely, pulses) for _, pulses, _ in rounds):
        unpushed = without(rows, likely)
        background = estimated(unpushed, background)
        nats = log_likelihood(background, unpushed) - cost(likely, n_place)
        rounds.append((nats, likely, background))
        likely, remaining, least = sought(background, len(likely))
    if not rounds:
        return []
    _, likely, likeliest = max(rounds, key=lambda one: one[0])
    if likeliest is not background:
        background, (_, remaining, least) = likeliest, sought(likeliest, len(likely))
    tail = Tail.of(remaining, least)
    places, blocks = log_places(n_place, len(likely)), np.log(max(n_joint * len(remaining), 1))

    def is_one(pulse: Pulse) -> bool:
        is_sized = pulse.sigmas > EQUAL_SIGMAS  # as of any cause
        # Beside a background that is estimated anew it is less evident: what is not enough before is not then.
        for anew in (False, True):
            nats = log_evidence(rows, likely, pulse, background, anew) if is_sized else -np.inf
            if not min(nats - places, tail.surprisal(nats) - blocks) > odds:
                return False
        return True

    return [pulse for pulse in likely if is_one(pulse)]


def _usual(whole: Background, rows: Sequence[Rows], share: float = 0.75) -> Background:
    """Return the background of those three quarters of the blocks that are likeliest by that of the whole.

    Pushes of a joint that seldom moves may be much of what is known of it. The share is a compromise of
    efficiency and robustness (Rousseeuw and Van Driessen 2006).
    """
    densities = [whole.mean_log_density(part, LONGEST_PULSE_S) for part in rows]
    known = np.concatenate([density[part.known] for density, part in zip(densities, rows, strict=True)])
    if len(known) == 0:
        return whole
    least = float(np.quantile(known, 1.0 - share))
    usual = [
        replace(part, known=part.known & (density >= least)) for density, part in zip(densities, rows, strict=True)
    ]
    return estimated(usual, whole)
