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
from fitter.marker_diagnosis.sliding_skin import slid, slopes
from fitter.marker_diagnosis.suspicion import Suspicion, known_in, log_normal
from fitter.marker_diagnosis.trial_errors import TrialErrors

#: How far off a marker is that was put on anew: examiners differ by up to 25 mm (Della Croce, Cappozzo and
#: Kerrigan 1999) [m].
_MOVED_M = 0.025
#: Seconds that the arm's own ``std_m`` counts for, as many as there are axes: the least for a covariance.
_PRIOR_SECONDS = 3


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
    slides = slopes(trials)
    n_marker = len(trials[0].names)
    sound = np.array([_sound(trials, m) for m in range(n_marker)])
    means = [(t.mean[m], t.std_m[m]) for t in trials for m in range(n_marker)]
    wander = Wander(sound, _share(means), _share([(one.amplitude, one.std_m) for one in slides]))
    found = [one for m in range(n_marker) for one in _moved(trials, m, sound[m])]
    found += _swapped(trials, sound)
    found += slid(trials, slides, wander.slope)
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


def _where(some: Sequence[int], known: Sequence[int]) -> tuple[tuple[int, ...], dict[str, object]]:
    """Return trials from 1, and what an effect says of them: nothing where it acts in all."""
    numbers = tuple(sorted(r + 1 for r in some))
    return numbers, {} if len(some) == len(known) else {"trials": list(numbers)}


def _moved(trials: Sequence[TrialErrors], m: int, wander: Floats) -> list[Suspicion]:
    """Return that a marker is moved, in the trials in which that is likeliest."""
    known = known_in(trials, m)
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
    return log_normal(x, null + shared) - log_normal(x, null)


def _swapped(trials: Sequence[TrialErrors], wander: Floats) -> list[Suspicion]:
    """Return which pairs of markers, exchanged, are nearer to where the others have them."""
    found = []
    for i, j in combinations(range(len(trials[0].names)), 2):
        known = [r for r in known_in(trials, i) if r in known_in(trials, j)]
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
        total += log_normal(means[one], 2.0 * wander[one]) - log_normal(trial.mean[one], 2.0 * wander[one])
    return total
