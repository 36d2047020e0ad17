"""What is left when all causes are taken into account: whether it is mere noise, and if not, on what it depends.

Dependence is asked for without a form: means over bins of a variable, taken from every other judging trial, say
how much of the residual of the others they explain. What chance explains is found by shifting the residual in
time, which keeps its own course.
"""

from dataclasses import dataclass

import numpy as np

from arm.model import Floats
from fitter.diagnosis.sensors.linearisation import Linearisation

_BINS, _SHIFTS = 12, 39
#: A variable counts that explains this share of what the best does.
_COUNTS = 0.3
_RIDGE = 1e-3


@dataclass(frozen=True)
class Remaining:
    """What is left.

    Attributes
    ----------
    explained : float
        Share of it that a flexible regression on the motion explains in trials it has not seen.
    white : bool
        It is no more than noise.
    depends_on : tuple of str
        Variables, the strongest first: ``t``, ``q1``, ``dq1``, ``ddq1`` …
    """

    explained: float
    white: bool
    depends_on: tuple[str, ...]


def remaining(judged: list[Linearisation], white: bool, rng: np.random.Generator) -> Remaining:
    """Describe what is left in the judging trials.

    Parameters
    ----------
    judged : list of Linearisation
        Along their fitted motions.
    white : bool
        It is no more than noise.
    rng : Generator
        Draws shifts.
    """
    if white or len(judged) < 2:
        return Remaining(0.0, white, ())
    left = [at.residual * at.weight for at in judged]
    names, motions = _variables(judged)
    found: dict[str, float] = {}
    for k, name in enumerate(names):
        column = [motion[:, k] for motion in motions]
        share = _by_bins(column, left)
        chance = []
        for _ in range(_SHIFTS):
            shifted = [np.roll(r, int(rng.integers(len(r) // 10, 9 * len(r) // 10)), axis=0) for r in left]
            chance.append(_by_bins(column, shifted))
        if share > max(chance):
            found[name] = share
    best = max(found.values(), default=0.0)
    order = sorted((name for name in found if found[name] > _COUNTS * best), key=lambda name: -found[name])
    return Remaining(_by_polynomial(motions, left), False, tuple(order))


def _variables(judged: list[Linearisation]) -> tuple[list[str], list[Floats]]:
    n = judged[0].q.shape[1]
    names = ["t", *(f"{kind}{j + 1}" for kind in ("q", "dq", "ddq") for j in range(n))]
    return names, [
        np.column_stack([at.trial.t, at.q, at.dq, np.gradient(at.dq, at.trial.dt_s, axis=0)]) for at in judged
    ]


def _by_bins(column: list[Floats], left: list[Floats]) -> float:
    edges = np.quantile(np.concatenate(column), np.linspace(0.0, 1.0, _BINS + 1)[1:-1])
    places = [np.searchsorted(edges, values) for values in column]
    gained = total = 0.0
    for half in (0, 1):
        means = np.zeros((_BINS, left[0].shape[1]))
        counts = np.zeros(_BINS)
        for place, r in zip(places[half::2], left[half::2], strict=True):
            np.add.at(means, place, r)
            counts += np.bincount(place, minlength=_BINS)
        means /= np.maximum(counts, 1.0)[:, None]
        for place, r in zip(places[1 - half :: 2], left[1 - half :: 2], strict=True):
            total += float(np.sum(r**2))
            gained += float(np.sum(r**2) - np.sum((r - means[place]) ** 2))
    return gained / total


def _by_polynomial(motions: list[Floats], left: list[Floats]) -> float:
    """Return what a polynomial of third degree and the directions of motion explain in trials left out."""
    whole = np.concatenate(motions)
    middle, size = whole.mean(axis=0), np.maximum(whole.std(axis=0), 1e-12)
    n = (whole.shape[1] - 1) // 3

    def features(motion: Floats) -> Floats:
        x = (motion - middle) / size
        pairs = [x[:, a] * x[:, b] for a in range(x.shape[1]) for b in range(a + 1)]
        signs = np.sign(motion[:, 1 + n : 1 + 2 * n])
        return np.column_stack([np.ones(len(x)), x, *pairs, x**3, signs, signs * x[:, 1 + n : 1 + 2 * n]])

    A = [features(motion) for motion in motions]
    gained = total = 0.0
    for out in range(len(A)):
        others = [k for k in range(len(A)) if k != out]
        normal = sum((A[k].T @ A[k] for k in others), np.zeros((A[0].shape[1],) * 2))
        right = sum((A[k].T @ left[k] for k in others), np.zeros((A[0].shape[1], left[0].shape[1])))
        x = np.linalg.solve(normal + _RIDGE * np.trace(normal) / len(normal) * np.eye(len(normal)), right)
        total += float(np.sum(left[out] ** 2))
        gained += float(np.sum(left[out] ** 2) - np.sum((left[out] - A[out] @ x) ** 2))
    return min(1.0, max(0.0, gained / total))
