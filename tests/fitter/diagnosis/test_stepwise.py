"""The search by a likelihood of its own: least squares of made-up columns, of which it knows nothing."""

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from fitter.diagnosis.stepwise import Stepwise, held_out_gain

N, BLOCKS = 400, 40


@dataclass
class Fit:
    chosen: tuple
    nats: np.ndarray
    trial: np.ndarray = field(default_factory=lambda: np.repeat(np.arange(8), 5))

    @property
    def learnt(self):
        return self.trial < 4

    @property
    def n_number(self):
        return len(self.chosen)


class Columns:
    """Some columns may explain a series; half of its trials are learnt from."""

    def __init__(self, columns, y):
        self.columns, self.y = columns, y

    def _fit(self, chosen):
        half, A = N // 2, self.columns[:, list(chosen)]
        x = np.linalg.lstsq(A[:half], self.y[:half], rcond=None)[0] if chosen else np.zeros(0)
        left = self.y - A @ x
        return Fit(tuple(chosen), -0.5 * np.sum(left.reshape(BLOCKS, -1) ** 2, axis=1))

    def fit_base(self):
        return self._fit(())

    def screen(self, fit):
        gains = [(self._fit((*fit.chosen, k)), k) for k in range(self.columns.shape[1]) if k not in fit.chosen]
        starts = [
            SimpleNamespace(hypothesis=k, gain=float((one.nats - fit.nats).sum()), n_start=1) for one, k in gains
        ]
        return sorted(starts, key=lambda one: -one.gain)

    def fit_all(self, fit, some):
        return [self._fit((*fit.chosen, *(start.hypothesis for start in starts))) for starts in some]

    def judge(self, fits):
        return list(fits)

    def refit(self, fit):
        return fit

    def fit_without(self, fit, place):
        return self._fit(tuple(k for at, k in enumerate(fit.chosen) if at != place))

    def is_possible(self, fit):
        return True

    def is_exact(self, fit):
        return False


def _columns(seed=0, k=6):
    return np.random.default_rng(seed).normal(size=(N, k))


def _found(columns, y):
    return Stepwise(Columns(columns, y), columns.shape[1]).run()


def test_both_causes_are_found_and_nothing_else():
    A = _columns()
    y = A[:, 1] - 0.7 * A[:, 4] + np.random.default_rng(1).normal(size=N)
    found = _found(A, y)
    assert {step.hypothesis for step in found.steps} == {1, 4}
    assert found.steps[0].hypothesis == 1
    assert held_out_gain(found.final, found.base) > 0.0


def test_noise_has_no_cause():
    found = _found(_columns(), np.random.default_rng(2).normal(size=N))
    assert found.steps == ()
    assert found.final is found.base


def test_two_that_hide_each_other_are_found_in_a_pair():
    A = _columns(3)
    A[:, 1] = -A[:, 0] + 0.05 * A[:, 1]
    y = 12.0 * (A[:, 0] + A[:, 1]) + np.random.default_rng(4).normal(size=N)
    found = _found(A, y)
    assert {step.hypothesis for step in found.steps} == {0, 1}


def test_an_equal_is_kept_beside_the_cause():
    A = _columns(5)
    A[:, 3] = A[:, 2]
    found = _found(A, A[:, 2] + np.random.default_rng(6).normal(size=N))
    (step,) = found.steps
    assert {step.hypothesis, step.equals[0].chosen[-1]} == {2, 3}
