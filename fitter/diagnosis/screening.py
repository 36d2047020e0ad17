"""Every hypothesis tried beside what is accepted: first on a grid of psi, the promising ones then refined."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from arm.effects.catalogue import catalogue
from arm.model import Floats
from fitter.diagnosis.agreement import agreed
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.loads import find_payloads
from fitter.diagnosis.model import Model
from fitter.diagnosis.pushes import find_pushes
from fitter.diagnosis.regression import Regression, scaled_lstsq

#: A hypothesis is refined if it explains this share of what the best one does on the learning trials …
_PROMISING = 0.3
#: … or if it is among so many of the best.
_AT_LEAST = 4
#: … as long as it explains this share of what is left.
_WORTH = 0.04
#: Events are found in coarse steps; they are refined if they explain this share of what the best one does.
_COMPETES = 0.6
#: One that explains less than this share of what the best one does is not looked at any further.
_LITTLE = 0.02
#: … nor one that explains less than this share of a trial's residual.
_NOTHING = 0.02
#: Peaks of the spectrum that may be a disturbance's frequency.
_PEAKS = 4


@dataclass(frozen=True)
class Candidate:
    """A model with one hypothesis more, and what it leaves.

    Attributes
    ----------
    model : Model
        What was accepted before, and the hypothesis as its last.
    x : (n_factor,)
        Base parameters and the columns' factors.
    squares : (n_trial,)
        Sum of squares that is left in each trial, in units of the noise.
    """

    model: Model
    x: Floats
    squares: Floats

    @property
    def hypothesis(self) -> Hypothesis:
        """What was added."""
        return self.model.hypotheses[-1]


def fitted(regression: Regression, model: Model, refine: bool = True, held: int = 0) -> Candidate:
    """Return a model fitted to the trials that may be learnt from, and what it leaves in all of them.

    Parameters
    ----------
    regression : Regression
    model : Model
    refine : bool
        Whether psi is sought, too.
    held : int
        So many hypotheses, from the first on, keep their psi.
    """
    motions = regression.motions if model.is_event else regression.learning
    if refine:
        model = regression.refined(model, motions, held)
    x = regression.solve(model, motions)[0]
    return Candidate(model, x, regression.squares(model, x))


def screen(
    regression: Regression,
    accepted: Candidate,
    tried: Sequence[Hypothesis],
    progress: Callable[[int, int], None] | None = None,
) -> list[Candidate]:
    """Return all hypotheses, fitted beside what is accepted, the most explaining first.

    Parameters
    ----------
    regression : Regression
    accepted : Candidate
        What they are added to.
    tried : sequence of Hypothesis
        Those that are no events; these are found here.
    progress : callable, optional
        Told how many are done, and how many there are.
    """
    grid = _Grid(regression, accepted.model)
    first = []
    total = len(tried) + 2
    for k, hypothesis in enumerate(tried):
        first.append(grid.best(hypothesis, accepted))
        if progress is not None:
            progress(k + 1, total)
    events = _events(regression, accepted)
    explained = np.array([gain for gain, _ in first])
    best = float(explained.max(initial=0.0))
    rank = np.argsort(np.argsort(-explained))
    candidates, held = [], len(accepted.model.hypotheses)
    alike = _fair(regression, accepted)
    for (gain, model), place in zip(first, rank, strict=True):
        if gain < max(_NOTHING * grid.left / len(regression.learning), _LITTLE * best):
            candidates.append(Candidate(model, accepted.x, accepted.squares))
            continue
        refine = gain >= _WORTH * grid.left and (gain >= _PROMISING * best or place < _AT_LEAST)
        candidate = fitted(regression, model, refine, held)
        candidates.append(alike(candidate) if candidate.model.is_event else candidate)
    leading = min((float(one.squares.sum()) for one in candidates), default=float(accepted.squares.sum()))
    for one in events:
        candidate = alike(fitted(regression, accepted.model.plus(one, one.starts([])[0]), refine=False))
        gain = float(accepted.squares.sum() - candidate.squares.sum())
        if gain > max(_WORTH * accepted.squares.sum(), _COMPETES * (accepted.squares.sum() - leading)):
            candidate = alike(fitted(regression, candidate.model, held=held))
        candidates.append(candidate)
    if progress is not None:
        progress(total, total)
    possible = [one if _possible(one) else Candidate(one.model, one.x, accepted.squares) for one in candidates]
    return sorted(possible, key=lambda one: float(one.squares.sum()))


def _fair(regression: Regression, accepted: Candidate) -> Callable[[Candidate], Candidate]:
    """Return what makes events comparable: they too predict the evaluating trials by what the learning ones tell.

    Only the size of what the learning trials do not show is told by the others.
    """
    if accepted.model.is_event:
        return lambda candidate: candidate

    def learnt(candidate: Candidate) -> Candidate:
        model = candidate.model
        x, A, _ = regression.solve(model, regression.learning)
        unseen = np.linalg.norm(A, axis=0) == 0.0
        judging = [motion for motion in regression.motions if not motion.learn]
        if np.any(unseen) and judging:
            rows = [regression.rows(model, motion) for motion in judging]
            left = [one.target.ravel() - one.design @ np.where(unseen, 0.0, x) for one in rows]
            x[unseen] = scaled_lstsq(np.vstack([one.design[:, unseen] for one in rows]), np.concatenate(left))
        return replace(candidate, squares=regression.squares(model, x))

    return learnt


def _possible(candidate: Candidate) -> bool:
    hypothesis = candidate.hypothesis
    factors = candidate.x[len(candidate.x) - hypothesis.n_column :]
    return hypothesis.possible(candidate.model.psi[-1], factors)


def _events(regression: Regression, accepted: Candidate) -> list[Hypothesis]:
    known = {hypothesis.key for hypothesis in accepted.model.hypotheses}
    kinds = catalogue()
    found: list[Hypothesis] = []
    if ("payload", ()) not in known:
        found += find_payloads(kinds["payload"], regression, accepted.model)
    expected = agreed(regression, accepted.model)
    pushes = find_pushes(kinds["external_push"], regression, accepted.model, expected)
    return found + [one for one in pushes if one.key not in known]


class _Grid:
    """What each start of a hypothesis would explain on the learning trials."""

    def __init__(self, regression: Regression, model: Model) -> None:
        self._regression, self._model = regression, model
        self._left_of_run: float | None = None
        rows = [regression.rows(model, motion) for motion in regression.learning]
        self._views = [regression.view(model, motion) for motion in regression.learning]
        A = np.vstack([one.design for one in rows])
        self._target = np.concatenate([one.target.ravel() for one in rows])
        size = np.linalg.norm(A, axis=0)
        Q, R, _ = scipy.linalg.qr(A / np.where(size > 0.0, size, 1.0), mode="economic", pivoting=True)
        told = np.abs(np.diag(R)) > 1e-9 * abs(R[0, 0])
        self._Q = Q[:, told]
        self._residual = self._target - self._Q @ (self._Q.T @ self._target)
        self.left = float(self._residual @ self._residual)

    def best(self, hypothesis: Hypothesis, accepted: Candidate) -> tuple[float, Model]:
        """Return by how much the best start lowers the sum of squares, and the model with it."""
        if hypothesis.is_event:
            return self._best_of_run(hypothesis)
        starts = hypothesis.starts(self._regression.learning)
        if isinstance(hypothesis, AtJoint) and "frequency_hz" in hypothesis.psi_names:
            starts = self._peaks(hypothesis)
        linear = isinstance(hypothesis, AtJoint) or hypothesis.n_column > 0
        gains = self._gains(hypothesis, starts) if linear else [self._gain(hypothesis, psi) for psi in starts]
        k = int(np.argmax(gains))
        model = self._model.plus(hypothesis, starts[k])
        if not hypothesis.is_gradual:
            return gains[k], model
        model = self._regression.refined(model, self._regression.learning, len(self._model.hypotheses))
        r = self._regression.solve(model, self._regression.learning)[2]
        return self.left - float(r @ r), model

    def _best_of_run(self, hypothesis: Hypothesis) -> tuple[float, Model]:
        """Return the same of what need not show in the learning trials, by all trials."""
        motions = self._regression.motions
        starts = hypothesis.starts(motions)
        if self._left_of_run is None:
            r = self._regression.solve(self._model, motions)[2]
            self._left_of_run = float(r @ r)
        gains = []
        for psi in starts:
            r = self._regression.solve(self._model.plus(hypothesis, psi), motions)[2]
            gains.append(self._left_of_run - float(r @ r))
        k = int(np.argmax(gains))
        return gains[k], self._model.plus(hypothesis, starts[k])

    def _gain(self, hypothesis: Hypothesis, psi: Floats) -> float:
        model = self._model.plus(hypothesis, psi)
        r = self._regression.solve(model, self._regression.learning)[2]
        return self.left - float(r @ r)

    def _gains(self, hypothesis: Hypothesis, starts: Floats) -> list[float]:
        """Return the gains of columns beside all others, those of all starts filtered together."""
        first, width = len(self._views[0].columns), hypothesis.n_column
        parts = []
        for view in self._views:
            added = [one for psi in starts for one in hypothesis.act(view, psi).columns[first:]]
            filtered = self._regression.weighting.filtered(view.motion, np.concatenate(added, axis=2))
            parts.append(filtered.reshape(-1, len(starts) * width))
        C = np.vstack(parts)
        size = np.linalg.norm(C, axis=0)
        C -= self._Q @ (self._Q.T @ C)
        fresh = np.linalg.norm(C, axis=0) > 1e-4 * size
        return [self._gain_of(C[:, k : k + width][:, fresh[k : k + width]]) for k in range(0, len(fresh), width)]

    def _gain_of(self, C: Floats) -> float:
        if not C.shape[1]:
            return 0.0
        r = self._residual - C @ scaled_lstsq(C, self._residual)
        return self.left - float(r @ r)

    def _peaks(self, hypothesis: AtJoint) -> Floats:
        """Return the frequencies at which the residual swings most, (n_peak, 1)."""
        regression = self._regression
        stride, n_joint = regression.weighting.stride, regression.arm.n_joint
        t = np.concatenate([motion.t[::stride] for motion in regression.learning])
        left = self._residual.reshape(-1, n_joint)[:, hypothesis.joints[0]]
        span = float(t[-1] - t[0])
        f = np.arange(0.05, regression.weighting.band_hz, 0.25 / span)
        power = np.empty(len(f))
        for some in np.array_split(np.arange(len(f)), max(1, len(f) // 256)):
            power[some] = np.abs(np.exp(-2j * np.pi * f[some, None] * t) @ left)
        found: list[float] = []
        for k in np.argsort(power)[::-1]:
            if all(abs(f[k] - other) > 1.0 / span for other in found):
                found.append(float(f[k]))
            if len(found) == _PEAKS:
                break
        return np.array(found)[:, None]
