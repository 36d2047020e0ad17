"""What may be wrong with markers, and how much likelier each makes the trials' mean errors.

A trial's mean error of a sound marker is normal: from motion to motion its place on the bone changes as it does
from second to second within one, and that is seen; the arm's own place was found in some motion, too. Under a
hypothesis a marker is centimetres away. Both have closed marginal likelihoods; their ratio is the evidence, in
nats.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy

from arm.model import Effect, Floats
from fitter.marker_diagnosis.trial_errors import TrialErrors

#: How far off a marker is that was put on anew: examiners differ by up to 25 mm (Della Croce, Cappozzo and
#: Kerrigan 1999) [m].
_MOVED_M = 0.025
#: By how much skin takes a marker with it: 10 to 30 mm at the thigh while hip and knee turn by about a radian
#: (Leardini et al. 2005) [m/rad].
_SLID_M_RAD = 0.02
#: Joints farther along the chain than this move other skin (a ball joint has three).
_NEAR = 3
#: Joints that turn by less, rms, slide no skin that could be seen [rad].
_LEAST_TURN = 0.05
#: Seconds that the arm's own ``std_m`` counts for, as many as there are axes: the least for a covariance.
_PRIOR_SECONDS = 3
#: Blocks that a slope needs: twice its three numbers.
_LEAST_BLOCKS = 6


@dataclass(frozen=True)
class Suspicion:
    """A hypothesis on some trials' mean errors.

    Attributes
    ----------
    effect : Effect
        With its numbers.
    std : mapping of str to float
        Of those that were estimated.
    evidence : float
        Log ratio of the marginal likelihoods [nats].
    trials : tuple of int
        In which it acts, from 1.
    """

    effect: Effect
    std: dict[str, float]
    evidence: float
    trials: tuple[int, ...]


@dataclass(frozen=True)
class Wander:
    """How far sound markers are from their places.

    Attributes
    ----------
    covariance : (m, 3, 3) [m²]
        Of each marker's mean errors, by those of single seconds.
    mean, slope : float
        Mean errors, and how far skin slides over a motion's range, as a share of the arm's ``std_m``: by the
        median over markers and trials, so that a few wrong ones have no say.
    """

    covariance: Floats
    mean: float
    slope: float


def suspicions(trials: Sequence[TrialErrors]) -> tuple[list[Suspicion], Wander]:
    """Return all hypotheses, the likeliest first, and the wander of sound markers."""
    slides = _slopes(trials)
    n_marker = len(trials[0].names)
    sound = np.array([_sound(trials, m) for m in range(n_marker)])
    means = [(t.mean[m], t.std_m[m]) for t in trials for m in range(n_marker)]
    wander = Wander(sound, _share(means), _share([(one.amplitude, one.std_m) for one in slides]))
    found = [one for m in range(n_marker) for one in _moved(trials, m, sound[m])]
    found += _swapped(trials, sound)
    found += [one.suspicion(trials, wander.slope) for one in slides]
    return sorted(found, key=lambda one: -one.evidence), wander


def _share(known: Sequence[tuple[Floats, float]]) -> float:
    """Return the rms of vectors as a share of their markers' std, by the median."""
    ratio = [float(value @ value) / std**2 for value, std in known if np.isfinite(value).all()]
    return float(np.sqrt(np.median(ratio) / scipy.stats.chi2.median(3))) if ratio else 1.0


def _sound(trials: Sequence[TrialErrors], m: int) -> Floats:
    """Return the covariance of a sound marker's mean errors, (3, 3) [m²].

    That of seconds' means about their trials', with the arm's ``std_m`` for three more of them (the expectation of
    an inverse Wishart posterior).
    """
    total, count = _PRIOR_SECONDS * trials[0].std_m[m] ** 2 * np.eye(3), _PRIOR_SECONDS
    for trial in trials:
        known = trial.block_means[np.isfinite(trial.block_means[:, m]).all(axis=1), m]
        if len(known) > 1:
            off = known - known.mean(axis=0)
            total, count = total + off.T @ off, count + len(known) - 1
    return np.asarray(total / count)


def _log_normal(x: Floats, covariance: Floats) -> float:
    sign, log_det = np.linalg.slogdet(covariance)
    return -0.5 * float(x @ np.linalg.solve(covariance, x)) - 0.5 * float(log_det) if sign > 0 else -np.inf


def _known(trials: Sequence[TrialErrors], m: int) -> list[int]:
    return [r for r, one in enumerate(trials) if np.isfinite(one.mean[m]).all()]


def _where(some: Sequence[int], known: Sequence[int]) -> tuple[tuple[int, ...], dict[str, object]]:
    """Return trials from 1, and what an effect says of them: nothing where it acts in all."""
    numbers = tuple(sorted(r + 1 for r in some))
    return numbers, {} if len(some) == len(known) else {"trials": list(numbers)}


def _moved(trials: Sequence[TrialErrors], m: int, wander: Floats) -> list[Suspicion]:
    """Return that a marker is moved, in the trials in which that is likeliest."""
    known = _known(trials, m)
    if not known:
        return []
    alone = {r: _evidence_moved(trials, m, [r], wander) for r in known}
    best: Suspicion | None = None
    order = sorted(known, key=lambda r: -alone[r])
    for n in range(1, len(order) + 1):
        some = order[:n]
        evidence = _evidence_moved(trials, m, some, wander)
        if best is not None and evidence <= best.evidence:
            continue
        covariance = wander * (1.0 + 1.0 / n)
        value = np.mean([trials[r].mean[m] for r in some], axis=0)
        numbers, where = _where(some, known)
        parameters = dict(zip(("x_m", "y_m", "z_m"), (float(x) for x in value), strict=True))
        std = dict(zip(parameters, np.sqrt(np.diag(covariance)).tolist(), strict=True))
        effect = Effect("marker_moved", parameters | where, markers=(trials[0].names[m],))
        best = Suspicion(effect, std, evidence, numbers)
    return [] if best is None else [best]


def _evidence_moved(trials: Sequence[TrialErrors], m: int, some: Sequence[int], wander: Floats) -> float:
    x = np.concatenate([trials[r].mean[m] for r in some])
    together = np.ones((len(some), len(some)))
    null = np.asarray(np.kron(np.eye(len(some)) + together, wander), dtype=np.float64)
    shared = np.asarray(_MOVED_M**2 * np.kron(together, np.eye(3)), dtype=np.float64)
    return _log_normal(x, null + shared) - _log_normal(x, null)


def _swapped(trials: Sequence[TrialErrors], wander: Floats) -> list[Suspicion]:
    """Return which pairs of markers, exchanged, are nearer to where the others have them."""
    found = []
    for i, j in combinations(range(len(trials[0].names)), 2):
        known = [r for r in _known(trials, i) if r in _known(trials, j)]
        gains = {r: _gain_swapped(trials[r], i, j, wander) for r in known}
        some = [r for r in known if gains[r] > 0.0]
        if not some:
            continue
        numbers, where = _where(some, known)
        effect = Effect("label_swap", where, markers=(trials[0].names[i], trials[0].names[j]))
        found.append(Suspicion(effect, {}, sum(gains[r] for r in some), numbers))
    return found


def _gain_swapped(trial: TrialErrors, i: int, j: int, wander: Floats) -> float:
    """Return by how much likelier the mean errors of two markers are if they are exchanged."""
    out, total = trial.out, 0.0
    crossed = {
        one: np.einsum("nji,nj->ni", out.axes[:, one], trial.y[:, other] - out.place[:, one])
        for one, other in ((i, j), (j, i))
    }
    means = trial.mean_of({one: np.where(np.isnan(error), 0.0, error) for one, error in crossed.items()})
    for one in (i, j):
        total += _log_normal(means[one], 2.0 * wander[one]) - _log_normal(trial.mean[one], 2.0 * wander[one])
    return total


@dataclass(frozen=True)
class _Slide:
    """How a marker's error goes with a joint, within trials."""

    m: int
    joint: int
    slope: Floats
    covariance: Floats
    turn: float
    std_m: float

    @property
    def amplitude(self) -> Floats:
        """By how much it slides with the joint's rms turn, (3,) [m]."""
        return self.slope * self.turn

    @property
    def spread(self) -> Floats:
        """Covariance of `amplitude`, (3, 3)."""
        return self.covariance * self.turn**2

    def suspicion(self, trials: Sequence[TrialErrors], share: float) -> Suspicion:
        """Return it as a hypothesis."""
        null: Floats = self.spread + (share * self.std_m) ** 2 * np.eye(3)
        slid = (_SLID_M_RAD * self.turn) ** 2 * np.eye(3)
        evidence = _log_normal(self.amplitude, null + slid) - _log_normal(self.amplitude, null)
        known = _known(trials, self.m)
        at = [float(np.mean(trials[r].q[:, self.joint])) for r in known]
        lag = [float(self.slope @ trials[r].mean[self.m]) / float(self.slope @ self.slope) for r in known]
        rest = float(np.mean(np.subtract(at, lag)))
        names = ("x_m_rad", "y_m_rad", "z_m_rad")
        parameters: dict[str, object] = dict(zip(names, self.slope.tolist(), strict=True))
        more = null / self.turn**2
        std = dict(zip(names, np.sqrt(np.diag(more)).tolist(), strict=True))
        parameters |= {"rest_rad": rest, "joint": self.joint + 1}
        effect = Effect("soft_tissue", parameters, markers=(trials[0].names[self.m],))
        return Suspicion(effect, std, evidence, tuple(r + 1 for r in known))


def _slopes(trials: Sequence[TrialErrors]) -> list[_Slide]:
    n_joint = trials[0].q.shape[1]
    found = []
    for m in range(len(trials[0].names)):
        link = int(trials[0].link[m])
        for joint in range(max(0, link - _NEAR + 1), min(n_joint, link + _NEAR + 1)):
            slide = _slope(trials, m, joint)
            if slide is not None:
                found.append(slide)
    return found


def _slope(trials: Sequence[TrialErrors], m: int, joint: int) -> _Slide | None:
    information, pull, power, count = np.zeros((3, 3)), np.zeros(3), 0.0, 0
    parts = []
    for trial in (trials[r] for r in _known(trials, m)):
        weight = trial.out.information[:, m]
        share = np.trace(weight, axis1=1, axis2=2)
        turn = np.where(share > 0.0, trial.q[:, joint] - np.average(trial.q[:, joint], weights=share), 0.0)
        off = np.nan_to_num(trial.out.error[:, m] - trial.mean[m])
        information += np.einsum("n,nij->ij", turn**2, weight)
        pull += np.einsum("n,nij,nj->i", turn, weight, off)
        power, count = power + float(turn @ turn), count + int((share > 0.0).sum())
        parts.append((trial, turn, weight, off))
    turned = float(np.sqrt(power / count)) if count else 0.0
    if turned < _LEAST_TURN or np.linalg.cond(information) > 1e12:
        return None
    covariance = np.linalg.inv(information)
    slope = covariance @ pull
    scores = []
    for trial, turn, weight, off in parts:
        own = np.zeros((trial.n_block, 3))
        np.add.at(own, trial.block, np.einsum("n,nij,nj->ni", turn, weight, off - turn[:, None] * slope))
        scores.append(own)
    all_scores = np.concatenate(scores)
    n = len(all_scores)
    if n < _LEAST_BLOCKS:
        return None
    covariance = covariance @ (all_scores.T @ all_scores) @ covariance * n / (n - 3)
    return _Slide(m, joint, slope, covariance, turned, float(trials[0].std_m[m]))
