"""Markers that go with a joint: all of a link as one body, or one of them."""

from types import SimpleNamespace

import numpy as np
import pytest

from fitter.marker_diagnosis.marker_hypotheses import suspicions
from fitter.marker_diagnosis.marker_search import ODDS_NATS

SECONDS, STD_M = 20, 0.004
PLACES = np.array([[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1], [-0.1, 0.05, 0], [0.05, -0.1, 0.05]])
#: Of another link, whose markers stay where they are: most of the limb's.
ELSEWHERE = np.random.default_rng(9).normal(scale=0.1, size=(10, 3))


def trial(slopes_m_rad, seed=0):
    """Return a trial in which one link's markers go with a joint by slopes (5, 3), a millimetre about it."""
    rng = np.random.default_rng(seed)
    m, n = len(PLACES) + len(ELSEWHERE), 5 * SECONDS
    q = 0.5 * rng.normal(size=n)
    slopes = np.vstack([slopes_m_rad, np.zeros_like(ELSEWHERE)])
    error = (q - q.mean())[:, None, None] * slopes + 1e-3 * rng.normal(size=(n, m, 3))
    error -= error.mean(axis=0)
    block = np.arange(n) // 5
    place = np.tile(np.vstack([PLACES, ELSEWHERE]), (n, 1, 1))
    out = SimpleNamespace(
        error=error,
        information=np.tile(np.eye(3) / STD_M**2, (n, m, 1, 1)),
        place=place,
        axes=np.tile(np.eye(3), (n, m, 1, 1)),
    )
    return SimpleNamespace(
        names=tuple(f"M{k}" for k in range(m)),
        std_m=np.full(m, STD_M),
        link=np.repeat([0, 1], [len(PLACES), len(ELSEWHERE)]),
        out=out,
        q=q[:, None],
        y=place + error,
        block=block,
        mean=np.zeros((m, 3)),
        block_means=np.array([error[block == b].mean(axis=0) for b in range(SECONDS)]),
        n_block=SECONDS,
        mean_of=lambda errors: {k: e.mean(axis=0) for k, e in errors.items()},
    )


@pytest.mark.parametrize("turn", [[0.0, 0.0, 0.1], [0.08, -0.05, 0.0]])
def test_an_axis_that_is_off_is_no_skin(turn):
    tried, _ = suspicions([trial(np.cross(turn, PLACES), seed=k) for k in range(2)])
    assert tried[0].evidence < ODDS_NATS


def test_one_marker_that_slides_is_told_from_an_axis():
    slope = np.array([0.01, -0.02, 0.015])
    slopes = np.cross([0.0, 0.0, 0.05], PLACES)
    slopes[2] += slope
    best = suspicions([trial(slopes, seed=k) for k in range(2)])[0][0]
    assert (best.effect.name, best.effect.markers) == ("soft_tissue", ("M2",))
    assert best.evidence > ODDS_NATS + np.log(20.0)
