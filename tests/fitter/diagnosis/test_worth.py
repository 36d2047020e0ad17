"""Which candidate is accepted, by what it leaves in every trial alone."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.hypothesis import Hypothesis
from fitter.diagnosis.model import Model
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.worth import best_of, more_to_find, reach, rivals_of

TRIALS, TOLD = 22, np.full(22, 300.0)
REGRESSION = cast(Regression, SimpleNamespace(motions=[SimpleNamespace(learn=k < 5) for k in range(TRIALS)]))
BASE = Candidate(Model(), np.zeros(3), np.full(TRIALS, 40.0) * TOLD)


def candidate(hypothesis: Hypothesis, ratios: np.ndarray | float) -> Candidate:
    model = Model().plus(hypothesis, np.zeros(len(hypothesis.low)))
    return Candidate(model, np.zeros(4), np.broadcast_to(ratios, TRIALS) * TOLD)


def at_joint(name: str) -> AtJoint:
    return AtJoint(catalogue()[name], 0)


def pushes(count: int = 1) -> Pushes:
    return Pushes(catalogue()["external_push"], 0, np.array([[2.0 + k, 0.3] for k in range(count)]))


def best(base: Candidate, *candidates: Candidate) -> Candidate | None:
    return best_of(REGRESSION, base, base, sorted(candidates, key=lambda one: float(one.squares.sum())), TOLD)


def test_what_explains_most_is_accepted():
    spring, drag = candidate(at_joint("joint_spring"), 1.0), candidate(at_joint("quadratic_drag"), 20.0)
    assert best(BASE, drag, spring) is spring


@pytest.mark.parametrize("left", [39.999, 40.0, 41.0])
def test_what_explains_next_to_nothing_is_not(left):
    assert best(BASE, candidate(at_joint("joint_spring"), left)) is None


def test_of_equals_the_one_with_fewest_numbers_is_taken():
    offset, ripple = candidate(at_joint("torque_offset"), 1.001), candidate(at_joint("cogging"), 1.0)
    assert best(BASE, ripple, offset) is offset


def test_what_explains_nothing_is_no_rival():
    drag, asymmetry, offset = (
        candidate(at_joint(name), left)
        for name, left in (("quadratic_drag", 39.9), ("coulomb_asymmetry", 39.91), ("torque_offset", 40.0))
    )
    base = float(BASE.squares.sum())
    assert rivals_of(drag, [drag, asymmetry, offset], base, 0.99 * base, TOLD) == [asymmetry]


def test_what_helps_only_where_it_was_fitted_is_not_accepted():
    ratios = np.where(np.arange(TRIALS) < 5, 1.0, 40.5)
    assert best(BASE, candidate(at_joint("joint_spring"), ratios)) is None


def test_a_cause_that_shows_in_every_trial_goes_before_pushes_that_explain_two_bad_ones():
    wild = np.where(np.arange(TRIALS) < 2, 4000.0, 40.0)
    base = Candidate(Model(), np.zeros(3), wild * TOLD)
    pushed = candidate(pushes(2), np.full(TRIALS, 40.0))
    play = candidate(at_joint("joint_spring"), np.where(wild > 100.0, 3900.0, 1.5))
    assert pushed.squares.sum() < play.squares.sum()
    assert best(base, pushed, play) is play


def test_pushes_that_explain_everything_are_named():
    pushed, spring = candidate(pushes(), 1.0), candidate(at_joint("joint_spring"), 25.0)
    assert best(BASE, pushed, spring) is pushed


def beside(first: Candidate, left: float) -> Candidate:
    """Return pushes beside a cause that gets some trials wrong, and what they leave in those."""
    wild = first.squares > 100.0 * TOLD
    return Candidate(first.model.plus(pushes(), np.zeros(0)), np.zeros(5), np.where(wild, left, 3.0) * TOLD)


@pytest.mark.parametrize(("given_way", "accepted"), [(300.0, False), (3.0, True)])
def test_a_second_cause_that_patches_a_bad_place_is_no_push_unless_the_first_gives_way(
    given_way: float, accepted: bool, monkeypatch: pytest.MonkeyPatch
):
    first = candidate(at_joint("joint_spring"), np.where(np.arange(TRIALS) < 2, 2000.0, 3.0))
    patched, healed, anew = (beside(first, left) for left in (300.0, 3.0, given_way))
    monkeypatch.setattr("fitter.diagnosis.worth.fitted", lambda _regression, _model: anew)
    assert (best_of(REGRESSION, BASE, first, [patched], TOLD) is patched) == accepted
    assert best_of(REGRESSION, BASE, first, [healed], TOLD) is healed


def test_noise_alone_hides_nothing():
    quiet = Candidate(Model(), np.zeros(3), 0.6 * TOLD)
    assert not more_to_find(quiet, quiet, TOLD)
    assert more_to_find(BASE, BASE, TOLD)


def test_no_formula_is_exact_but_none_is_excused_for_much():
    one = candidate(at_joint("joint_spring"), 1.0)
    told = float(TOLD.sum())
    near, far = (reach(one, gain, TOLD) - one.squares.sum() for gain in (told, 1e6 * told))
    assert 0.01 * told <= near <= far <= 0.1 * told
