"""When a cause is believed: by scores that are made up."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from fitter.reading_diagnosis.sensor_hypotheses import Fitted, SensorHypothesis, Suspect
from fitter.reading_diagnosis.sensor_search import Tried
from fitter.reading_diagnosis.sensor_verdict import ACCEPTED, EQUAL, _beats, _support, decide, significant
from fitter.reading_diagnosis.suspected_effects import EFFECTS

KINDS = {kind.name: kind for kind in reversed(EFFECTS)}

N = 8
NOTHING = Fitted(
    SensorHypothesis((), (), np.zeros((4, 3)), np.zeros(4, dtype=np.bool_)), [], 0.0, np.eye(12), np.zeros(N)
)


def tried(effect, value, score, each=None, std=0.01):
    """Return a suspect of sensor 1 with some numbers, all of one standard error."""
    suspect, value = Suspect(KINDS[effect], 1), np.array(value)
    hypothesis = replace(NOTHING.hypothesis, suspects=(suspect,), values=(value,))
    covariance = np.diag(np.r_[np.ones(12), np.full(len(value), std**2)])
    fitted = replace(NOTHING, hypothesis=hypothesis, covariance=covariance)
    return Tried(suspect, score, fitted, np.full(N, score / N) if each is None else each)


class Made:
    """A search that finds what it is given, once."""

    noise, base = 1.0, NOTHING

    def __init__(self, before, *found):
        self.before, self.found = before, found

    def try_all(self, _known):
        return list(self.found)

    def score(self, _fitted):
        return self.before

    def settle(self, fitted):
        return fitted

    def doubtful(self, _fitted):
        return False


BIAS = tried("sensor_bias", [0.3, 0.0, 0.0], 100.0)


def test_numbers_differ_from_nothing_by_four_standard_errors():
    assert significant(Made(0.0), BIAS) == 1
    assert significant(Made(0.0), tried("sensor_bias", [0.03, 0.05, -0.05], 0.0)) == 2
    assert significant(Made(0.0), tried("sensor_scale", [1.0, 1.03, 1.0], 0.0)) == 0
    assert significant(Made(0.0), tried("sensor_highpass", [0.001], 0.0, std=1e-5)) == 0  # forgets nothing


def test_what_explains_enough_is_accepted_and_what_explains_less_is_not():
    rng = np.random.default_rng(0)
    (cause,) = decide(Made(100.0 + 1.1 * ACCEPTED, BIAS), rng).causes
    assert (cause.tried, cause.equals, cause.support) == (BIAS, (), 1.0)
    assert decide(Made(100.0 + 0.9 * ACCEPTED, BIAS), rng).causes == ()


def test_a_rival_as_good_with_as_many_numbers_is_its_equal_and_one_with_more_is_not():
    rng, before = np.random.default_rng(0), 1000.0
    scale, turned = tried("sensor_scale", [1.3, 1.0, 1.0], 105.0), tried("mounting_radius", [0.3, 0.3, 0.0], 95.0)
    (cause,) = decide(Made(before, BIAS, scale, turned), rng).causes
    assert (cause.tried, cause.equals) == (BIAS, (scale,))
    worse = tried("sensor_scale", [1.3, 1.0, 1.0], 100.0 + 2.1 * EQUAL)
    (cause,) = decide(Made(before, BIAS, worse), rng).causes
    assert cause.equals == ()


def test_one_beats_another_by_more_than_what_trials_scatter():
    each = np.full(N, 10.0)
    spread = each + 20.0 * np.array([1.0, -1.0] * (N // 2))
    steady = tried("sensor_bias", [0.3, 0.0, 0.0], 80.0, each)
    wild = tried("sensor_bias", [0.3, 0.0, 0.0], 80.0 + 1.5 * EQUAL, spread)
    assert _beats(steady, replace(wild, each=each + 1.5 * EQUAL / N)) > 0.0 > _beats(steady, wild)


def test_support_is_how_often_trials_drawn_anew_prefer_it():
    rng = np.random.default_rng(0)
    each = rng.normal(size=N)
    best = tried("sensor_bias", [0.3, 0.0, 0.0], 0.0, np.zeros(N))
    other = tried("sensor_scale", [1.3, 1.0, 1.0], float(np.sum(each - each.mean())), each - each.mean())
    assert _support(best, [other], rng) == pytest.approx(0.5, abs=0.07)  # its differences have the mean 0
    assert _support(best, [], rng) == 1.0


def test_a_level_is_one_that_clipped_frames_lie_beyond(monkeypatch):
    level = tried("sensor_clipping", [4.0], 0.0)
    search = SimpleNamespace(noise=1.0, trials=None)
    for beyond, n in ((10.0, 1), (1.0, 0)):
        monkeypatch.setattr(
            "fitter.reading_diagnosis.sensor_verdict.beyond_level", lambda *_, beyond=beyond: beyond
        )
        assert significant(search, level) == n
