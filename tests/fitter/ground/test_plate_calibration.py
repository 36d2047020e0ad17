"""Plates that stand and read wrong, by what bodies that are known leave."""

import numpy as np
import pytest

from benchmarks.simulated_people.ground import BASE, PERSON, moving, other_masses, trial_of, weighing
from fitter.ground.disturbances import plate_columns
from fitter.ground.ground_dynamics import learn_from_ground

OFF = np.array([0.004, -0.002, 0.0, 3.0, -2.0, 1.0])


@pytest.fixture(scope="module")
def found():
    """Plates that are off, z of what was found, and the force's share that is found in another trial."""
    numbers = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        theta = other_masses(BASE, rng)
        person, trials = weighing(PERSON, theta), []
        for _ in range(2):
            q = moving(PERSON, rng, 8.0)
            noise = rng.normal(0.0, [1.0] * 3 + [0.3] * 3, (len(q), 6))
            one = trial_of(person, BASE, q, q, theta, noise)
            wrench = one.wrench + plate_columns(one.wrench) @ OFF
            trials.append(type(one)(**{**one.__dict__, "wrench": wrench}))
        numbers.append((learn_from_ground(person, BASE, trials[:1], regression=True, band_hz=2.0), trials[1]))
    return numbers


def test_zeros_and_places_are_found_within_their_errors(found):
    z = np.array([(fit.plates.value - OFF) / fit.plates.std for fit, _ in found])
    assert np.mean(np.abs(z) < 1.96) > 0.9
    assert np.abs(np.mean([fit.plates.value[3:5] for fit, _ in found], axis=0) - OFF[3:5]).max() < 0.5


def test_the_wrench_of_another_trial_is_put_right(found):
    for fit, trial in found:
        true = plate_columns(trial.wrench) @ OFF
        left = true - fit.plates.wrench(trial.wrench)
        assert np.mean(left[:, :2] ** 2) < 0.2 * np.mean(true[:, :2] ** 2)


def test_the_document_parts_places_from_zeros(found):
    plates = found[0][0].plates
    said = plates.document()
    assert said["place_m"] == {"value": plates.value[:3].tolist(), "std": plates.std[:3].tolist()}
    assert said["zero_N"] == {"value": plates.value[3:].tolist(), "std": plates.std[3:].tolist()}
