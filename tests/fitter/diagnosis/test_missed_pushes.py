"""A push is found in what a model misses, with its own sign, and none where there is none."""

import numpy as np
import pytest

from arm.model import Effect
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.missed_pushes import _pushed_significantly, missed, pushed, with_pushes
from fitter.diagnosis.model import Model
from fitter.diagnosis.screening import fitted
from fitter.diagnosis.torque_likelihood import TorqueLikelihood
from tests.fitter.diagnosis.searched import swinging

#: In the fourth and the seventh trial of three seconds each: one that may be learnt from, and one that may not.
PUSHES = ((10.2, 0.4, 1.5), (19.4, 0.5, -1.2))


def run(*pushes):
    effects = [
        Effect("external_push", {"start_s": start, "duration_s": lasts, "torque_N_m": torque}, joints=(1,))
        for start, lasts, torque in pushes
    ]
    likelihood = TorqueLikelihood(swinging(*effects), [])
    base = likelihood.base()
    return likelihood.regression, base.candidate


@pytest.fixture(scope="module")
def hit():
    return run(*PUSHES)


def test_pushes_are_found_with_their_times_and_torques(hit):
    regression, base = hit
    found = with_pushes(regression, base)
    (numbers,) = estimates(regression, found).effects
    values = np.array([one.value for one in numbers.values()]).reshape(-1, 3)
    values = values[np.argsort(values[:, 0])]
    assert len(values) == len(PUSHES)
    np.testing.assert_allclose(values[:, :2], np.array(PUSHES)[:, :2], atol=0.06)
    np.testing.assert_allclose(values[:, 2], np.array(PUSHES)[:, 2], rtol=0.15)
    hit_trials = [any(one.t[0] < start < one.t[-1] for start, *_ in PUSHES) for one in regression.motions]
    assert np.all(found.squares[hit_trials] < 0.5 * base.squares[hit_trials])


def test_what_is_missed_has_the_sign_of_the_push(hit):
    regression, base = hit
    for start, lasts, torque in PUSHES:
        parts = [part for part in missed(regression, base) if part.t[0] < start < part.t[-1]]
        (part,) = parts
        during = (part.t > start + 0.1) & (part.t < start + lasts - 0.1)
        # The base parameters take a part of what pushes that may be learnt from do.
        assert 0.5 < np.mean(part.r[during, 0]) / torque < 1.2


def test_where_nothing_pushes_the_model_stays_as_it_is():
    regression, base = run()
    assert with_pushes(regression, base) is base


def test_pushes_stand_behind_what_always_acts(hit):
    regression, base = hit
    found = pushed(regression, fitted(regression, Model()), {0: [PUSHES[0][:2]]})
    (hypothesis,) = found.model.hypotheses
    assert hypothesis.key == ("external_push", (0,))
    np.testing.assert_allclose(found.model.psi[0][:2], PUSHES[0][:2], atol=0.1)


def test_a_push_of_no_size_is_none(hit):
    regression, base = hit
    starts = [start for start, *_ in PUSHES]
    quiet = next(one for one in regression.motions if not any(one.t[0] < s < one.t[-1] for s in starts))
    nowhere = (float(quiet.t[len(quiet.t) // 2]), 0.3)
    times = {0: [nowhere, *((start, lasts) for start, lasts, _ in PUSHES)]}
    found = _pushed_significantly(regression, base, times)
    (numbers,) = estimates(regression, found).effects
    assert len(numbers) == 3 * len(PUSHES)
    assert _pushed_significantly(regression, base, {0: [nowhere]}) is base
