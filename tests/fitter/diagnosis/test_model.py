"""A model moved a little: towards either side, and no further than its numbers may go."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.estimates import estimates
from fitter.diagnosis.in_transmission import InTransmission
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.play import play_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.screening import fitted
from tests.fitter.pendulum import pendulum, swings

PLAY, TWIST = (InTransmission(catalogue()[name], [0]) for name in ("backlash", "joint_elasticity"))


@pytest.mark.parametrize("psi", [PLAY.low, np.array([0.03]), PLAY.high])
def test_a_model_is_moved_within_its_bounds(psi):
    ((more, less, apart),) = Model((PLAY,), (psi,)).beside()
    assert PLAY.low <= less.psi[0] <= psi <= more.psi[0] <= PLAY.high
    assert apart == more.flat[0] - less.flat[0] > 0.0


def test_one_number_at_a_time():
    model = Model((PLAY, TWIST), (np.array([0.03]), np.array([1e-3, 1e-2])))
    moved = [np.flatnonzero(more.flat != less.flat).tolist() for more, less, _ in model.beside()]
    assert moved == [[0], [1], [2]]
    assert not list(Model().beside())


def test_where_little_changes_jump_an_error_stays_what_it_is():
    effect = Effect("backlash", {"gap_rad": 0.02}, joints=(1,))
    trials = to_trials(swings((effect,), trials=4, seed=1), cutoff_hz=25.0)
    regression = Regression(pendulum(), run_of(pendulum(), trials[:3], trials[3:]))
    plays = [play_of(pendulum(), motion, 0) for motion in regression.motions[:3]]

    def off(gap: float) -> float:
        return sum(float(np.sum(np.abs(play.off(gap)))) for play in plays)

    gaps = 0.02 * np.linspace(0.25, 0.4, 1501)  # too small, so that crossings seem too long
    for _ in range(3):  # … and one more is believed from some gap on
        at = int(np.argmax(np.abs(np.diff([off(gap) for gap in gaps]))))
        gaps = np.linspace(gaps[at], gaps[at + 1], 101)
    found = []
    for gap in (0.99 * gaps[0], gaps[0], 1.01 * gaps[-1]):
        one = fitted(regression, Model((PLAY,), (np.array([gap]),)), refine=False)
        found.append(estimates(regression, one).effects[0]["gap_rad"].std)
    assert max(found) < 2.0 * min(found)
