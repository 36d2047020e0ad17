"""Contact that is measured for a time: which stretches are judged, and on which clock."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.simulated_people.ground import BASE, PERSON, moving, other_masses, trial_of, weighing
from fitter.ground.ground_trial import SHORTEST_S
from fitter.ground.link_names import link_names
from fitter.ground.measured_contact import measured_stretches, unmeasured

NAMES = link_names(PERSON)


@pytest.fixture(scope="module")
def stood():
    """Return a person and a trial of 9 s in which plates measure all contact."""
    rng = np.random.default_rng(4)
    theta = other_masses(BASE, rng)
    person, q = weighing(PERSON, theta), moving(PERSON, rng, 10.0)
    return person, trial_of(person, BASE, q, q, theta, np.zeros((len(q), 6)))


def sat(trial, begin_s, end_s):
    """Return the trial with a chair that carries all of the person for a time."""
    t = trial.t - trial.t[0]
    return replace(trial, wrench=trial.wrench * ((t < begin_s) | (t >= end_s))[:, None])


def test_a_trial_with_all_contact_measured_contradicts_nothing(stood):
    assert unmeasured(stood[0], BASE, stood[1], NAMES) == []


@pytest.mark.parametrize(("begin_s", "end_s"), [(0.0, 3.0), (2.5, 5.0), (6.0, 10.0)])
def test_the_stretches_beside_a_chair_are_returned_and_none_on_it(stood, begin_s, end_s):
    person, trial = stood
    trial = sat(trial, begin_s, end_s)
    assert unmeasured(person, BASE, trial, NAMES)
    parts = measured_stretches(person, BASE, trial, NAMES)
    t = np.concatenate([part.t for part in parts]) - trial.t[0]
    assert not np.any((t >= begin_s) & (t < end_s))
    longest = max(begin_s, trial.t[-1] - trial.t[0] - end_s)
    assert max(part.t[-1] - part.t[0] for part in parts) > longest - 0.5
    assert all(
        len(part.t) == len(part.Y) == len(part.motions[0].o) == len(part.postures[0].value) for part in parts
    )


def test_a_plate_that_is_missing_throughout_leaves_no_stretch(stood):
    person, trial = stood
    assert measured_stretches(person, BASE, replace(trial, wrench=0.5 * trial.wrench), NAMES) == []


def test_a_steady_rail_leaves_no_stretch(stood):
    person, trial = stood
    leant = replace(trial, wrench=trial.wrench + np.array([0.08 * 588.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert measured_stretches(person, BASE, leant, NAMES) == []


def test_no_stretch_is_shorter_than_a_trial_may_be(stood):
    person, trial = stood
    chair = np.sin(2.0 * np.pi * (trial.t - trial.t[0]) / 1.5) > 0.0
    assert measured_stretches(person, BASE, replace(trial, wrench=trial.wrench * chair[:, None]), NAMES) == []
    assert SHORTEST_S == 1.0


def test_the_clock_is_the_stretches_own(stood):
    person, trial = stood
    about = trial.motions[BASE.bodies[0]].o
    fixed = np.hstack([trial.wrench[:, :3], trial.wrench[:, 3:] + np.cross(about, trial.wrench[:, :3])])
    late = np.column_stack([np.interp(trial.t - 0.04, trial.t, column) for column in fixed.T])
    wrench = np.hstack([late[:, :3], late[:, 3:] - np.cross(about, late[:, :3])])
    parts = measured_stretches(person, BASE, sat(replace(trial, wrench=wrench), 4.0, 6.0), NAMES)
    first = parts[0]
    assert abs(first.shift.shift_s - 0.04) < 3.0 * first.shift.std_s < 0.02
    inner = slice(0, len(first.t) - 10)
    same = trial.wrench[np.searchsorted(trial.t, first.t[inner])]
    assert np.sqrt(np.mean((first.wrench[inner] - same) ** 2)) < 0.3 * np.sqrt(
        np.mean((wrench - trial.wrench) ** 2)
    )
