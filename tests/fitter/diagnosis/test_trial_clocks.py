"""Effects of an arm file on a run's clock, and back."""

from dataclasses import replace

import numpy as np
import pytest

from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.run import run_of
from fitter.diagnosis.trial_clocks import begins_in, entries, on_run, on_trials, trial_at
from tests.fitter.pendulum import pendulum, swings

PUSH = Effect(
    "external_push", {"start_s": 2.0, "duration_s": 0.3, "torque_N_m": 1.5, "trials": ["swing 3"]}, joints=(1,)
)
LOAD = Effect("payload", {"mass_kg": 0.2, "trials": ["swing 2", "swing 4"]})
LATER = Effect("payload", {"mass_kg": 0.2, "trials": ["swing 3", "swing 4"], "since_s": 2.0})


def run(labels=None):
    motions = swings((), trials=4)
    for k, label in enumerate(labels or ()):
        motions[k] = replace(motions[k], labels=np.full(len(motions[k].t), label))
    trials = to_trials(motions, cutoff_hz=25.0)
    return run_of(pendulum(), trials[:3], trials[3:])


def same(one, other):
    numbers = ({k: v for k, v in each.parameters.items() if k != "trials"} for each in (one, other))
    return one.parameters["trials"] == other.parameters["trials"] and next(numbers) == pytest.approx(next(numbers))


def test_a_push_is_on_the_clock_of_its_trial():
    motions = run()
    (pushed,) = on_run([PUSH], motions)
    third = motions[2]
    since = pushed.parameters["start_s"] - float(third.t[0])
    assert third.trial.began_s + since == pytest.approx(2.0)
    assert pushed.parameters["trials"] == [3]


@pytest.mark.parametrize("effect", [PUSH, LOAD], ids=["push", "load"])
def test_there_and_back_it_is_the_same(effect):
    motions = run()
    (back,) = on_trials(on_run([effect], motions), motions)
    assert same(back, effect)


def test_a_load_from_a_moment_on_has_that_trials_clock():
    motions = run()
    at = 2.0 + motions[2].ahead_s
    (later,) = on_trials([Effect("payload", {"mass_kg": 0.2, "since_s": at})], motions)
    assert same(later, LATER)
    begun = {tuple(one.parameters["trials"]): one.parameters.get("since_s") for one in on_run([later], motions)}
    assert begun == {(4,): None, (3,): pytest.approx(at)}


def test_on_one_clock_a_moment_needs_no_trial():
    motions = swings((), trials=2)
    motions[1] = replace(motions[1], t=motions[1].t + 3.0)
    trials = to_trials(motions, cutoff_hz=25.0)
    one_clock = run_of(pendulum(), trials[:1], trials[1:])
    later = Effect("payload", {"mass_kg": 0.2, "since_s": 4.0})
    assert on_trials([later], one_clock) == [later]


def test_labels_that_count_go_before_names():
    assert list(entries(run()).values()) == [f"swing {k}" for k in (1, 2, 3, 4)]
    assert list(entries(run(("11", "12", "12", "last"))).values()) == [11, "swing 2", "swing 3", "swing 4"]


def test_an_instant_between_trials_is_in_the_next():
    motions = run()
    gap = 0.5 * (motions[0].t[-1] + motions[1].t[0])
    assert begins_in(motions, gap) is motions[1]
    assert trial_at(motions, float(motions[2].t[5])) is motions[2]
