"""The normal equations of trials are those of their readings, the motion eliminated."""

from dataclasses import replace

import numpy as np
import pytest

from arm.arm_file import load_arm
from fitter.reading_diagnosis.sensor_frames import trials_of
from fitter.reading_diagnosis.sensor_hypotheses import Suspect, with_suspect
from fitter.reading_diagnosis.sensor_search import first_motions
from fitter.reading_diagnosis.suspected_effects import EFFECTS
from fitter.reading_diagnosis.trial_equations import Trials

KINDS = {kind.name: kind for kind in EFFECTS}


@pytest.fixture(scope="module")
def trials(measured_run):
    run = measured_run
    return Trials(run.arm, trials_of(run.arm, [*run.learn, *run.evaluate]), len(run.learn))


@pytest.fixture(scope="module")
def starts(trials):
    return first_motions(trials.arm, trials.trials)


def test_trials_on_threads_are_as_one_by_one(trials, starts):
    nothing = trials.nothing()
    together = trials.all_eliminated(range(len(starts)), nothing, starts, ())
    for number, (gram, back) in enumerate(together):
        alone = trials.eliminated(number, nothing, starts[number], ())
        np.testing.assert_array_equal(gram, alone[0])
        np.testing.assert_array_equal(back, alone[1])


def test_what_a_bias_takes_away_is_foretold(trials, starts):
    """Along the same motion the problem is linear in a bias: its column says what the residual becomes."""
    nothing, bias = trials.nothing(), np.zeros((4, 3))
    bias[2, 1] = 0.05
    (gram, _), (moved, _) = (
        trials.eliminated(1, one, starts[1], ()) for one in (nothing, replace(nothing, bias=bias))
    )
    x = bias.ravel()
    foretold = gram[-1, -1] - 2.0 * x @ gram[:-1, -1] + x @ gram[:-1, :-1] @ x
    assert moved[-1, -1] == pytest.approx(foretold, rel=1e-9)


def test_only_an_angle_that_no_reading_shows_is_anchored(trials):
    assert not trials._anchored.any()  # gravity shows both of a vertical arm
    level = load_arm("dd-arm")
    assert Trials(level, trials.trials, 3)._anchored.tolist() == [True, False]


def test_what_is_not_looked_at_is_counted(trials, starts):
    nothing = trials.nothing()
    assert trials.dropped(3, nothing, starts[3]) == 0
    late = Suspect(KINDS["time_skew"], 1)
    delayed = with_suspect(nothing, late, np.array([0.05]))
    looked_at = trials.linearised(3, delayed, starts[3]).weight > 0.0
    count = trials.dropped(3, delayed, starts[3])  # what a late sensor reads past the end of the motion
    assert count == np.count_nonzero((trials.trials[3].weight > 0.0) & ~looked_at)
    assert 0 < count < 0.1 * looked_at.size


def test_nothing_is_walked_without_what_forgets(trials, starts):
    nothing = trials.nothing()
    at = trials.linearised(3, nothing, starts[3])
    assert trials.explained(3, nothing, starts[3]).expected.tolist() == at.expected.tolist()
    free = replace(nothing, free_base=True)
    assert trials.walked(3, at, free, starts[3]).shape == (len(at.weight), 3)
