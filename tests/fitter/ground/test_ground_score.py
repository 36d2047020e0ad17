"""How bodies are judged by the ground's forces."""

import numpy as np

from fitter.ground.ground_score import ground_score, worse_than_nothing
from tests.fitter.ground.simulated_ground import BASE, PERSON, moving, other_masses, trial_of


def judged(theta, found):
    rng = np.random.default_rng(1)
    q = moving(PERSON, rng, 4.0)
    trial = trial_of(PERSON, BASE, q, q, theta, np.zeros((len(q), 6)))
    return ground_score(PERSON, BASE, [trial], theta, found, 2.0)


def test_the_true_bodies_explain_all():
    theta = other_masses(BASE, np.random.default_rng(0))
    score = judged(theta, theta)
    assert np.allclose(score.explained, 1.0)
    assert worse_than_nothing(BASE, {"learn": score, "evaluate": None}) == ()


def test_bodies_worse_than_none_are_named_by_joint():
    theta = other_masses(BASE, np.random.default_rng(0))
    score = judged(theta, -0.1 * theta)  # leaves 1.1 times what was there
    notes = worse_than_nothing(BASE, {"learn": score, "evaluate": score})
    assert len(notes) == 12 and {note.kind for note in notes} == {"unexplained"}
    assert "joint 1 the learnt bodies predict the ground's reaction in the learning trials" in notes[0].text
    assert "121 % of its power" in notes[0].text
