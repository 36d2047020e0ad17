"""Contact that no plate measures is found; where all is measured nothing is."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.simulated_people.ground import BASE, DT, PERSON, moving, other_masses, trial_of, weighing
from fitter.ground.contact import closure, held, plate_link

UP = np.array([0.0, 0.0, 1.0])


def closed(seed, change=lambda wrench, t: wrench):
    rng = np.random.default_rng(seed)
    theta = other_masses(BASE, rng)
    person = weighing(PERSON, theta)
    q = moving(PERSON, rng, 6.0)
    trial = trial_of(person, BASE, q, q, theta, np.zeros((len(q), 6)))
    predicted = trial.Y[:, :3] @ BASE.links.ravel()
    weight = 9.80665 * theta[9::10].sum()
    return closure(predicted, change(trial.wrench, trial.t)[:, :3], float(weight), UP, trial.t, DT)


@pytest.mark.parametrize("seed", range(3))
def test_all_measured_is_never_refused(seed):
    assert not closed(seed)


@pytest.mark.parametrize("seed", range(3))
def test_a_plate_that_is_missing_is_found(seed):
    assert closed(seed, lambda wrench, t: wrench * (0.5 + 0.1 * np.sin(t))[:, None])


def test_a_rail_that_is_leant_on_steadily_is_found():
    assert closed(1, lambda wrench, t: wrench + np.array([35.0, 0.0, 0.0, 0.0, 0.0, 0.0]))


def test_a_box_stepped_off_is_found_with_its_time():
    notes = closed(0, lambda wrench, t: wrench * (t > t[0] + 2.0)[:, None])
    assert notes[0].kind == "unmeasured_contact"
    assert notes[0].from_s is not None and notes[0].from_s < 1.5 < notes[0].to_s < 4.0


def test_a_chair_sat_on_for_most_of_a_trial_is_found_with_its_time():
    (note,) = closed(0, lambda wrench, t: wrench * (t > t[0] + 4.0)[:, None])
    assert note.kind == "unmeasured_contact" and "throughout" not in note.text
    assert note.from_s is not None and note.from_s < 1.0 and 4.0 < note.to_s < 5.5


def test_a_plate_that_reads_half_is_said_to_do_so_throughout():
    (note,) = closed(0, lambda wrench, t: 0.5 * wrench)
    assert "throughout" in note.text and note.from_s is None


def test_a_hand_that_stands_still_while_the_trunk_sways_holds_a_rail():
    rng = np.random.default_rng(2)
    q = moving(PERSON, rng, 6.0, size=0.2)
    trial = trial_of(PERSON, BASE, q, q, BASE.links.ravel(), np.zeros((len(q), 6)))
    hand, ground = BASE.bodies[-1], np.array([0.0, 0.0, -1.0])
    assert not held(BASE, trial.motions, [hand], ["hand_left"], ground, UP, trial.t, DT)
    motions = list(trial.motions)
    motions[hand] = replace(motions[hand], o=motions[hand].o[:1] + 0.001 * rng.normal(size=motions[hand].o.shape))
    (note,) = held(BASE, motions, [hand], ["hand_left"], ground, UP, trial.t, DT)
    assert "hand_left" in note.text


def test_a_plate_acts_on_the_body_nearest_to_its_load():
    q = np.zeros((50, PERSON.n_joint))
    trial = trial_of(PERSON, BASE, np.zeros((150, PERSON.n_joint)), np.zeros((150, PERSON.n_joint)),
                     BASE.links.ravel(), np.zeros((150, 6)))  # fmt: skip
    foot = BASE.bodies[4]
    link = BASE.links[4]
    at = trial.motions[foot].o + trial.motions[foot].R @ (link[6:9] / link[9])
    assert plate_link(BASE, trial.motions, at + [0.02, 0.0, -0.05], np.ones(len(q), dtype=bool)) == foot
