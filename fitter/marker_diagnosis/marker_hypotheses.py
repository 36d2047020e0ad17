"""What may be wrong with markers, and how much likelier each makes the trials' mean errors.

A trial's mean error of a sound marker is normal: skin and glue let it wander, by a share of the arm's `std_m` that all
markers and trials tell together (its median, so that a few wrong ones have no say). Under a hypothesis a marker is
centimetres away. Both have closed marginal likelihoods; their ratio is the evidence, in nats.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.stats import chi2

from arm.model import Effect, Floats
from fitter.marker_diagnosis.trial_errors import TrialErrors

#: How far off a marker is that was put on anew: examiners differ by up to 25 mm (Della Croce, Cappozzo and Kerrigan
#: 1999) [m].
_MOVED_M = 0.025
#: By how much skin takes a marker with it, over the range of a motion: 10 to 30 mm at the thigh (Leardini et al.
#: 2005) [m].
_SLID_M = 0.02
#: Joints farther along the chain than this move other skin (a ball joint has three).
_NEAR = 3
#: Joints that turn by less, rms, slide no skin that could be seen [rad].
_LEAST_TURN = 0.05
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
    """How far sound markers' mean errors and slopes are from nothing, as a share of the arm's `std_m`."""

    mean: float
    slope: float


def suspicions(trials: Sequence[TrialErrors]) -> tuple[list[Suspicion], Wander]:
    """Return all hypotheses, the likeliest first, and the wander of sound markers."""
    slides = _slopes(trials)
    means = [(t.mean[m], t.spread[m], t.std_m[m]) for t in trials for m in range(len(t.names))]
    wander = Wander(_share(means), _share([(one.amplitude, one.spread, one.std_m) for one in slides]))
    found = [one for m in range(len(trials[0].names)) for one in _moved(trials, m, wander.mean)]
    found += _swapped(trials, wander.mean)
    found += [one.suspicion(trials, wander.slope) for one in slides]
    return sorted(found, key=lambda one: -one.evidence), wander


def _share(known: Sequence[tuple[Floats, Floats, float]]) -> float:
    """Return the wander as a share of the markers' std: by the median, less what blocks' scatter makes of it."""
    ratio = [
        (float(value @ value) - float(np.trace(spread))) / std**2
        for value, spread, std in known
        if np.isfinite(value).all() and np.isfinite(spread).all()
    ]
    if not ratio:
        return 1.0
    return float(np.sqrt(max(np.median(ratio) / chi2.median(3), 0.0)))


def _log_normal(x: Floats, covariance: Floats) -> float:
    sign, log_det = np.linalg.slogdet(covariance)
    return -0.5 * float(x @ np.linalg.solve(covariance, x)) - 0.5 * float(log_det) if sign > 0 else -np.inf


def _known(trials: Sequence[TrialErrors], m: int) -> list[int]:
    return [r for r, one in enumerate(trials) if np.isfinite(one.mean[m]).all()]


def _where(some: Sequence[int], known: Sequence[int]) -> tuple[tuple[int, ...], dict[str, object]]:
    """Return trials from 1, and what an effect says of them: nothing where it acts in all."""
    numbers = tuple(sorted(r + 1 for r in some))
    return numbers, {} if len(some) == len(known) else {"trials": list(numbers)}


def _moved(trials: Sequence[TrialErrors], m: int, share: float) -> list[Suspicion]:
    """Return that a marker is moved, in the trials in which that is likeliest."""
    known = _known(trials, m)
    if not known:
        return []
    sound = {r: trials[r].spread[m] + (share * trials[r].std_m[m]) ** 2 * np.eye(3) for r in known}
    alone = {r: _evidence_moved(trials, m, [r], sound) for r in known}
    best: Suspicion | None = None
    order = sorted(known, key=lambda r: -alone[r])
    for n in range(1, len(order) + 1):
        some = order[:n]
        evidence = _evidence_moved(trials, m, some, sound)
        if best is not None and evidence <= best.evidence:
            continue
        weight = {r: np.linalg.inv(sound[r]) for r in some}
        covariance = np.linalg.inv(sum(weight.values()))
        value = covariance @ sum(weight[r] @ trials[r].mean[m] for r in some)
        numbers, where = _where(some, known)
        parameters = dict(zip(("x_m", "y_m", "z_m"), (float(x) for x in value), strict=True))
        std = dict(zip(parameters, np.sqrt(np.diag(covariance)).tolist(), strict=True))
        effect = Effect("marker_moved", parameters | where, markers=(trials[0].names[m],))
        best = Suspicion(effect, std, evidence, numbers)
    return [] if best is None else [best]


def _evidence_moved(trials: Sequence[TrialErrors], m: int, some: Sequence[int], sound: dict[int, Floats]) -> float:
    n = 3 * len(some)
    x = np.concatenate([trials[r].mean[m] for r in some])
    null = np.zeros((n, n))
    for k, r in enumerate(some):
        null[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = sound[r]
    shared = _MOVED_M**2 * np.kron(np.ones((len(some), len(some))), np.eye(3))
    return _log_normal(x, null + shared) - _log_normal(x, null)


def _swapped(trials: Sequence[TrialErrors], share: float) -> list[Suspicion]:
    """Return which pairs of markers, exchanged, are nearer to where the others have them."""
    found = []
    for i, j in combinations(range(len(trials[0].names)), 2):
        known = [r for r in _known(trials, i) if r in _known(trials, j)]
        gains = {r: _gain_swapped(trials[r], i, j, share) for r in known}
        some = [r for r in known if gains[r] > 0.0]
        if not some:
            continue
        numbers, where = _where(some, known)
        effect = Effect("label_swap", where, markers=(trials[0].names[i], trials[0].names[j]))
        found.append(Suspicion(effect, {}, sum(gains[r] for r in some), numbers))
    return found


def _gain_swapped(trial: TrialErrors, i: int, j: int, share: float) -> float:
    """Return by how much likelier the mean errors of two markers are if they are exchanged."""
    out, total = trial.out, 0.0
    crossed = {
        one: np.einsum("nji,nj->ni", out.axes[:, one], trial.y[:, other] - out.place[:, one])
        for one, other in ((i, j), (j, i))
    }
    means = trial.mean_of({one: np.where(np.isnan(error), 0.0, error) for one, error in crossed.items()})
    for one in (i, j):
        usual = np.linalg.inv(trial.out.information[:, one].sum(axis=0) + 1e-12 * np.eye(3))
        usual = usual * len(trial.block) / trial.n_block + (share * trial.std_m[one]) ** 2 * np.eye(3)
        total += _log_normal(means[one], usual) - _log_normal(trial.mean[one], usual)
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
        null = self.spread + (share * self.std_m) ** 2 * np.eye(3)
        evidence = _log_normal(self.amplitude, null + _SLID_M**2 * np.eye(3)) - _log_normal(self.amplitude, null)
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
