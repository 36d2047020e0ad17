"""Simulated people whose tables are off by 20 %: what is learnt, what stays, and whether the errors are honest."""

import numpy as np

from arm.physical_links import is_possible
from benchmarks.simulated_people.ground import BASE, PERSON, moving, other_masses, trial_of, weighing
from fitter.ground.ground_dynamics import learn_from_ground
from fitter.ground.ground_score import ground_score


def learnt(seed, seconds=8.0, angle_rad=0.02):
    """Learn from one trial whose angles are off as skin makes them, judge on another."""
    rng = np.random.default_rng(seed)
    theta = other_masses(BASE, rng)
    person = weighing(PERSON, theta)
    gain = 1.0 + angle_rad * rng.normal(size=PERSON.n_joint)  # a posture is seen alike each time
    trials = []
    for _ in range(2):
        q = moving(PERSON, rng, seconds)
        noise = rng.normal(0.0, [1.0] * 3 + [0.3] * 3, (len(q), 6))
        trials.append(trial_of(person, BASE, q, q * gain, theta, noise))
    fit = learn_from_ground(person, BASE, trials[:1], regression=True, band_hz=2.0)
    return theta, fit, ground_score(person, BASE, trials[1:], fit.before, fit.values, fit.plates, 2.0)


def test_people_off_their_tables_are_learnt_with_errors_that_hold():
    z = []
    for seed in range(3):
        theta, fit, score = learnt(seed)
        said = score.document()["squared_reduction"]
        assert said["moment"] > 0.8 and said["force"] > 0.5
        assert all(is_possible(link) for link in fit.values.reshape(-1, 10))
        assert abs(fit.total_kg[0] / theta[9::10].sum() - 1.0) < 0.01
        z += [(c.value - np.array(list(c.terms.values())) @ theta) / c.std for c in fit.combinations]
    assert len(z) > 10
    assert np.mean(np.abs(z) < 1.96) > 0.9


def test_a_person_who_stands_teaches_hardly_more_than_weight_and_centre():
    rng = np.random.default_rng(5)
    theta = other_masses(BASE, rng)
    person = weighing(PERSON, theta)
    q = moving(PERSON, rng, 8.0, size=0.005)
    trial = trial_of(person, BASE, q, q, theta, rng.normal(0.0, 0.5, (len(q), 6)))
    fit = learn_from_ground(person, BASE, [trial], regression=True, band_hz=2.0)
    assert len(fit.combinations) <= 4
    assert np.mean(fit.learnt < 0.1) > 0.8
    assert fit.total_kg[1] < 0.01 * fit.total_kg[0]
