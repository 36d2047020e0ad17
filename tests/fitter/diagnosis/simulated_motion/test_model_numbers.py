"""Factors and psi of a model as numbers of the arm that has its effects."""

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.estimates import estimates, extended_arm
from fitter.diagnosis.model import Candidate, Model
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.simulated_motion.model_numbers import model_numbers
from tests.fitter.diagnosis.searched import swinging

PUSHES = Pushes(catalogue()["external_push"], 0, np.array([[1.0, 0.2], [4.0, 0.3]]))
DRAG = AtJoint(catalogue()["quadratic_drag"], 0)


@pytest.fixture(scope="module")
def found():
    regression = swinging(trials=2)
    model = Model().plus(PUSHES, np.zeros(0)).plus(DRAG, np.zeros(0))
    n_base = len(regression.solve(Model(), regression.motions))
    x = np.concatenate([regression.solve(Model(), regression.motions), [0.5, -0.4, 0.3]])
    candidate = Candidate(model, x, np.zeros(2))
    numbers = estimates(regression, candidate)
    arm = extended_arm(regression, candidate, numbers)
    kept = regression.equations.independent(regression.view(model, regression.motions[0]).arm)
    return model_numbers(arm, numbers, candidate, kept.tolist(), 0), n_base


def test_the_start_is_what_the_arm_has(found):
    numbers, _ = found
    assert [effect.name for effect in numbers.numbers.arm.effects] == ["external_push"] * 2 + ["quadratic_drag"]
    np.testing.assert_allclose(numbers.values(numbers.start), numbers.numbers.values)
    np.testing.assert_allclose(numbers.start[-3:], [0.5, -0.4, 0.3])


def test_what_is_moved_is_moved_in_the_arm_and_what_comes_and_goes_stays(found):
    numbers, n_base = found
    np.testing.assert_array_equal(numbers.lasting, [*[True] * n_base, False, False, True])
    flat = numbers.start
    flat[0] += 0.1
    flat[-3:] = 9.0, 9.0, 0.7
    moved = numbers.values(flat) - numbers.numbers.values
    assert moved[numbers.base[0]] == pytest.approx(0.1)
    assert np.count_nonzero(np.abs(moved) > 1e-12) == 2 and moved[-1] == pytest.approx(0.4)
    assert numbers.at(flat).x[-1] == 0.7 and numbers.at(flat).model is not numbers.candidate.model


def test_numbers_stay_within_the_catalogue(found):
    numbers, _ = found
    flat = numbers.start
    assert np.all(numbers.admitted(flat) >= 0.0)
    flat[-1] = -0.1
    assert np.min(numbers.admitted(flat)) == pytest.approx(-0.1)
