"""Trials by number and by name."""

import math

import numpy as np
import pytest

from arm.effects.effect_table import effect_table
from arm.effects.trials import TrialId, acts_from, acts_in, trial_id
from arm.model import Effect


@pytest.mark.parametrize(
    ("trials", "trial", "acts"),
    [
        (None, 3, True),
        ([2, 3], 3, True),
        ([2], 3, False),
        (["swing", 7], TrialId(3, "swing"), True),
        ([3], TrialId(3, "swing"), True),
        (["rest"], TrialId(3, "swing"), False),
    ],
)
def test_an_effect_acts_in_trials_listed_by_number_or_name(trials, trial, acts):
    assert acts_in({} if trials is None else {"trials": trials}, trial) is acts


def test_a_label_that_counts_is_the_trials_number():
    assert trial_id(3, "13", "learn/13") == (13, "learn/13")
    assert trial_id(3, "slow", "learn/slow") == (3, "learn/slow")


def test_a_load_begins_in_the_first_trial_listed():
    values = {"mass_kg": 0.2, "trials": ["r3", "r4"], "since_s": 2.0}
    begun = [acts_from(values, TrialId(k, f"r{k}")) for k in (2, 3, 4)]
    assert begun == [float("inf"), 2.0, float("-inf")]


def test_a_push_acts_in_its_own_trial_only(arm, having):
    pushed = having(arm, "external_push", start_s=1.0, duration_s=0.1, torque_N_m=2.0, trials=["r2"])
    assert [len(effect_table(pushed, TrialId(k, f"r{k}")).joint) for k in (1, 2, 3)] == [0, 1, 0]


def test_an_effect_of_no_list_acts_in_every_trial():
    assert acts_in(Effect("payload", {"mass_kg": 0.1}).parameters, 99)


@pytest.mark.parametrize(
    ("values", "trial", "since"),
    [
        ({}, 1, -math.inf),
        ({"since_s": 3.5}, 7, 3.5),
        ({"trials": [2, 4]}, 4, -math.inf),
        ({"trials": np.array([2, 4])}, 3, math.inf),
        ({"trials": (2,), "since_s": 3.5}, 2, 3.5),
        ({"trials": [2], "since_s": 3.5}, 1, math.inf),
    ],
)
def test_it_acts_from_some_time_on_in_its_trials(values, trial, since):
    assert acts_from(values, trial) == since
