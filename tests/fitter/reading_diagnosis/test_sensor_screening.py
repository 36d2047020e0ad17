"""What one elimination foretells of a fit, and the frequencies at which a base moves."""

from types import SimpleNamespace

import numpy as np
import pytest

from fitter.reading_diagnosis.sensor_fit import fit
from fitter.reading_diagnosis.sensor_frames import trials_of
from fitter.reading_diagnosis.sensor_hypotheses import Fitted, Suspect, with_suspect
from fitter.reading_diagnosis.sensor_screening import base_frequencies, screened
from fitter.reading_diagnosis.sensor_search import first_motions
from fitter.reading_diagnosis.suspected_effects import EFFECTS
from fitter.reading_diagnosis.trial_equations import Trials

KINDS = {kind.name: kind for kind in reversed(EFFECTS)}


def test_what_is_linear_is_foretold_as_it_is_fitted(measure):
    run = measure(changed={1: {"bias_m_s2": (0.3, -0.2, 0.25)}})
    trials = Trials(run.arm, trials_of(run.arm, [*run.learn, *run.evaluate]), len(run.learn))
    known = trials.nothing()
    fitted = fit(
        trials,
        with_suspect(known, Suspect(KINDS["sensor_bias"], 1), np.zeros(3)),
        first_motions(run.arm, trials.trials),
    )
    (foretold,) = screened(trials, known, [(Suspect(KINDS["sensor_bias"], 1), np.zeros(3))], fitted.motions)
    np.testing.assert_allclose(foretold.value, fitted.hypothesis.values[0], atol=0.02)
    (scale,) = screened(trials, known, [(Suspect(KINDS["sensor_scale"], 1), np.ones(3))], fitted.motions)
    assert foretold.learn < scale.learn and foretold.judge < scale.judge


@pytest.mark.parametrize("hz", [0.7, 3.1])
def test_the_highest_peak_is_where_the_base_moves(hz):
    def linearised(number, _hypothesis, _motion):
        t = np.arange(400) * 0.01 + 4.0 * number
        shaken = np.outer(np.sin(2.0 * np.pi * hz * t), [0.3, -0.2, 0.1])
        noise = 0.05 * np.random.default_rng(number).normal(size=shaken.shape)
        eye = np.broadcast_to(np.eye(3), (len(t), 3, 3))
        return SimpleNamespace(
            trial=SimpleNamespace(t=t), residual=shaken + noise, weight=np.ones((len(t), 3)), from_base=lambda: eye
        )

    trials = SimpleNamespace(n_learn=3, trials=[SimpleNamespace(dt_s=0.01)], linearised=linearised)
    empty = np.zeros((0, 0))
    hypothesis = Trials.nothing(SimpleNamespace(arm=SimpleNamespace(sensors=(1,))))
    found = base_frequencies(trials, Fitted(hypothesis, [empty] * 3, 0.0, empty, empty))
    assert found[0] == pytest.approx(hz, abs=0.02)
