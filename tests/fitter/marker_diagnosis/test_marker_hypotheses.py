"""Evidence for markers that are wrong, against closed forms."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from fitter.marker_diagnosis.marker_hypotheses import suspicions


def trial(means, seconds=20, std_m=0.004, seed=0):
    """Return a trial whose markers' seconds scatter by a millimetre about some means (m, 3) [m]."""
    rng = np.random.default_rng(seed)
    m = len(means)
    scatter = 1e-3 * rng.normal(size=(seconds, m, 3))
    blocks = means + scatter - scatter.mean(axis=0)
    n = 2 * seconds
    error = np.repeat(blocks, 2, axis=0)
    place = np.arange(m)[None, :, None] * np.ones((n, m, 3))
    axes = np.tile(np.eye(3), (n, m, 1, 1))
    out = SimpleNamespace(
        error=error, information=np.tile(np.eye(3) / std_m**2, (n, m, 1, 1)), place=place, axes=axes
    )

    def mean_of(errors):
        return {k: error.mean(axis=0) for k, error in errors.items()}

    return SimpleNamespace(
        names=tuple(f"M{k}" for k in range(m)),
        std_m=np.full(m, std_m),
        link=np.zeros(m, dtype=int),
        out=out,
        q=np.zeros((n, 1)),
        y=place + error,
        block=np.arange(n) // 2,
        mean=np.asarray(means, dtype=float),
        block_means=blocks,
        n_block=seconds,
        mean_of=mean_of,
    )


def test_the_evidence_is_the_ratio_of_two_normal_densities():
    x = np.array([0.01, -0.02, 0.005])
    tried, wander = suspicions([trial(np.array([x, np.zeros(3)]))])
    best = tried[0]
    C = wander.covariance[0]
    wide = multivariate_normal(np.zeros(3), 2.0 * C + 0.025**2 * np.eye(3)).logpdf(x)
    expected = wide - multivariate_normal(np.zeros(3), 2.0 * C).logpdf(x)
    assert (best.effect.name, best.effect.markers) == ("marker_moved", ("M0",))
    assert best.evidence == pytest.approx(expected, rel=1e-9)


def test_a_marker_is_wrong_in_the_trials_in_which_it_is():
    moved, sound = np.array([[0.02, 0.0, 0.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
    tried, _ = suspicions([trial(sound, seed=1), trial(moved, seed=2), trial(moved, seed=3), trial(sound, seed=4)])
    assert tried[0].trials == (2, 3)
    assert tried[0].effect.parameters["trials"] == [2, 3]
    assert tried[0].effect.parameters["x_m"] == pytest.approx(0.02, abs=3.0 * tried[0].std["x_m"])


def test_millimetres_are_no_evidence():
    """The wander that is seen within trials may as well be between them."""
    tried, _ = suspicions([trial(np.array([[0.001, 0.0, 0.0], [0.0, 0.001, 0.0]]), seed=k) for k in range(3)])
    assert tried[0].evidence < 0.0


def test_exchanged_markers_outdo_two_that_moved():
    crossed = trial(np.zeros((2, 3)))
    crossed.y = crossed.out.place[:, ::-1] + 0.0
    off = crossed.y - crossed.out.place
    crossed.out.error = off
    crossed.mean = off.mean(axis=0)
    crossed.block_means = crossed.block_means * 0.0 + crossed.mean
    tried, _ = suspicions([crossed])
    assert (tried[0].effect.name, set(tried[0].effect.markers)) == ("label_swap", {"M0", "M1"})
