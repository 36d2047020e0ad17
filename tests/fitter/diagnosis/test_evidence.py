"""Worth counts numbers, places and families; equality is a difference within its scatter."""

from dataclasses import dataclass

import numpy as np

from fitter.diagnosis.evidence import dispersion, is_better, standard_error, worth


@dataclass
class Model:
    nats: np.ndarray
    n_number: int

    @property
    def trial(self):
        return np.repeat(np.arange(len(self.nats) // 10), 10)

    @property
    def learnt(self):
        return self.trial < len(self.nats) // 20


def _models(gain, numbers=1, scatter=0.1, seed=0):
    rng = np.random.default_rng(seed)
    base = rng.normal(-50.0, 1.0, 100)
    return Model(base + gain + scatter * rng.normal(size=100), numbers), Model(base, 0)


def test_worth_is_the_gain_less_numbers_places_and_families():
    one, base = _models(0.5, scatter=0.0)
    expected = 50.0 - 0.5 * np.log(100) - np.log(7) - np.log(30)
    np.testing.assert_allclose(worth(one, base, 7, 30), expected)


def test_gains_that_resemble_their_neighbours_count_less():
    rng = np.random.default_rng(1)
    trial = np.repeat(np.arange(10), 10)
    alone = rng.normal(size=100)
    together = np.repeat(rng.normal(size=50), 2)
    assert dispersion(alone, trial) < 1.3
    assert 1.3 < dispersion(together, trial) < 2.0
    assert standard_error(together, trial) > standard_error(alone, trial)


def test_a_difference_within_its_scatter_is_none():
    rng = np.random.default_rng(2)
    noise = rng.normal(size=100)
    noise -= noise.mean()
    base = Model(np.zeros(100), 1)
    assert is_better(Model(noise + 1.0, 1), base)
    assert not is_better(Model(noise + 0.1, 1), base)
    assert not is_better(Model(noise + 1.0, 1 + 40), base)
