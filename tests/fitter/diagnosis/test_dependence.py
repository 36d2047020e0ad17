"""Chatterjee's correlation against its definition, and what chance gives."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.stats

from fitter.diagnosis import cross_validation
from fitter.diagnosis.cross_validation import _xi, dependences
from fitter.diagnosis.model import Candidate, Model

FINAL = Candidate(Model(), np.zeros(0), np.zeros(0))


def run(residual):
    """Return a run of one joint that swings through 2 rad at 0.3 Hz, of which ``residual(q)`` remains."""
    t = np.arange(4000) * 0.01
    q = np.sin(2.0 * np.pi * 0.3 * t)[:, None]
    motion = SimpleNamespace(t=t, q=q, dq=np.gradient(q, 0.01, axis=0), ddq=-q, residual=residual(q))
    return SimpleNamespace(motions=[motion], arm=SimpleNamespace(n_joint=1))


@pytest.fixture(autouse=True)
def remaining(monkeypatch):
    monkeypatch.setattr(
        cross_validation, "residual_torque", lambda _regression, _model, _x, motion: motion.residual
    )


def test_ranks_that_go_up_steadily_are_all_but_a_function():
    n = 200
    assert _xi(np.arange(1.0, n + 1.0)) == pytest.approx(1.0 - 3.0 * (n - 1.0) / (n * n - 1.0))


def test_it_is_scipys():
    x, y = np.random.default_rng(2).normal(size=(2, 100))
    y += x**2
    ranks = (np.argsort(np.argsort(y)) + 1.0)[np.argsort(x)]
    assert _xi(ranks) == pytest.approx(scipy.stats.chatterjeexi(x, y).statistic)


def test_it_scatters_about_zero_as_chatterjee_says_where_there_is_no_dependence():
    rng, n = np.random.default_rng(0), 400
    drawn = np.array([_xi(rng.permutation(n).astype(np.float64)) for _ in range(400)])
    assert abs(drawn.mean()) < 4.0 * np.sqrt(2.0 / 5.0 / n / 400)
    assert drawn.std() == pytest.approx(np.sqrt(2.0 / 5.0 / n), rel=0.15)  # his limit law: variance 2 / (5 n)


def test_a_function_of_the_angle_is_one_and_noise_is_none():
    rng = np.random.default_rng(1)
    ripple = run(lambda q: np.sin(9.0 * q) + 0.1 * rng.normal(size=q.shape))
    cogging = {one.variable: one for one in dependences(ripple, FINAL)}
    assert cogging["q1"].p <= 0.01 and cogging["q1"].xi > 0.5
    noise = dependences(run(lambda q: rng.normal(size=q.shape)), FINAL)
    assert min(one.p for one in noise) > 0.01 / len(noise) and max(one.xi for one in noise) < 0.1


def test_where_a_joint_hardly_moves_nothing_is_said():
    assert dependences(run(lambda q: np.full(q.shape, np.nan)), FINAL) == []
