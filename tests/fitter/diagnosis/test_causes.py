"""Causes that stand beside one another, and the rivals that each of them has."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis import ascent
from fitter.diagnosis.ascent import Ascent
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.causes import find_causes
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.pushes import Pushes
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.candidate import Candidate
from fitter.diagnosis.screening import fitted, screen
from fitter.diagnosis.search import Cause
from fitter.diagnosis.starts import Starts
from tests.fitter.pendulum import pendulum, stop_that_no_learning_trial_reaches, swings

DISTURBANCE = Effect(
    "periodic_disturbance", {"amplitude_N_m": 0.2, "frequency_hz": 1.31, "phase_rad": 0.4}, joints=(1,)
)


def beside_disturbance(effect: Effect, *names: str) -> tuple[Regression, list[AtJoint]]:
    """Return a pendulum's run with an effect beside the disturbance, and what is tried: that and others."""
    trials = to_trials(swings((DISTURBANCE, effect), trials=8, seed=7), cutoff_hz=25.0)
    regression = Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    return regression, [AtJoint(catalogue()[name], 0) for name in (DISTURBANCE.name, *names)]


def test_beside_another_cause_equals_stay_equals():
    """Without the offset the disturbance's frequency is another; its rival was then tried with that one only."""
    offset = Effect("torque_offset", {"torque_N_m": 0.3}, joints=(1,))
    regression, tried = beside_disturbance(offset, "torque_offset", "coulomb_asymmetry")
    search = find_causes(regression, tried)
    places = {
        search.final.model.hypotheses[cause.place].kind.name: {one.hypothesis.kind.name for one in cause.rivals}
        for cause in search.causes
    }
    alike = {"torque_offset", "coulomb_asymmetry"}
    assert "periodic_disturbance" in places
    (name,) = set(places) - {"periodic_disturbance"}
    assert {name} | places[name] == alike


def test_a_search_made_anew_goes_on_from_what_was_found_and_doubts_it(monkeypatch: pytest.MonkeyPatch):
    drag = Effect("quadratic_drag", {"drag_N_m_s2": 0.05}, joints=(1,))
    regression, tried = beside_disturbance(drag, "quadratic_drag", "joint_spring")
    search = find_causes(regression, tried)
    true = {("periodic_disturbance", (0,)), ("quadratic_drag", (0,))}
    assert {one.key for one in search.final.model.hypotheses} == true
    spurious = fitted(regression, search.final.model.plus(tried[2], tried[2].starts(regression.learning)[0]))
    before = replace(search, final=spurious, causes=[*search.causes, Cause(2)])
    monkeypatch.setattr(Ascent, "on", lambda *_: pytest.fail("it began anew"))
    again = find_causes(regression, tried, before=before)
    assert {one.key for one in again.final.model.hypotheses} == true
    assert len(again.causes) == 2
    np.testing.assert_allclose(again.final.squares, search.final.squares, rtol=1e-3)


def test_what_was_tried_beside_the_same_causes_is_not_tried_again(monkeypatch: pytest.MonkeyPatch):
    """The cause that was found last is doubted by what came of trying everything beside those before it."""
    drag = Effect("quadratic_drag", {"drag_N_m_s2": 0.05}, joints=(1,))
    regression, tried = beside_disturbance(drag, "quadratic_drag", "joint_spring")
    beside: list[tuple[str, ...]] = []

    def counted(regression: Regression, accepted: Candidate, *others: Any) -> list[Candidate]:
        beside.append(tuple(one.kind.name for one in accepted.model.hypotheses))
        return screen(regression, accepted, *others)

    monkeypatch.setattr(ascent, "screen", counted)
    search = find_causes(regression, tried)
    assert len(search.causes) == 2
    assert {(), ("quadratic_drag",)} <= set(beside)
    assert len(beside) == len(set(beside))


@pytest.mark.parametrize("promised", [True, False])
def test_what_could_be_no_equal_is_not_fitted_anew(monkeypatch: pytest.MonkeyPatch, promised: bool):
    """Where the other psi are far off, all candidates may look alike; only what promises to do well is fitted."""
    offset = Effect("torque_offset", {"torque_N_m": 0.3}, joints=(1,))
    regression, tried = beside_disturbance(offset, "torque_offset", "coulomb_asymmetry", "quadratic_drag")
    disturbance, *others = tried
    model = fitted(regression, Model().plus(disturbance, np.array([1.31])).plus(others[0], np.zeros(0))).model
    itself, rest = fitted(regression, model), fitted(regression, model.without(1))
    rival = others[1] if promised else others[2]
    nothing = [Candidate(rest.model.plus(one, np.zeros(0)), rest.x, rest.squares) for one in (others[0], rival)]
    found = ascent._with_itself(regression, rest, nothing, itself, Starts(), regression.told)
    (came,) = [one for one in found if one.hypothesis is rival]
    assert (came.squares is not rest.squares) == promised
    if promised:
        assert came.squares.sum() == pytest.approx(itself.squares.sum(), rel=0.02)


def test_with_a_wrong_filter_no_more_is_sought_than_explains_nearly_all(monkeypatch: pytest.MonkeyPatch):
    """It will be made anew, and everything tried beside these causes then."""
    drag = Effect("quadratic_drag", {"drag_N_m_s2": 0.05}, joints=(1,))
    regression, tried = beside_disturbance(drag, "quadratic_drag", "joint_spring")
    most: list[int] = []

    def counted(regression: Regression, accepted: Candidate, *others: Any) -> list[Candidate]:
        most.append(len(accepted.model.hypotheses))
        return screen(regression, accepted, *others)

    monkeypatch.setattr(ascent, "screen", counted)
    true = {("periodic_disturbance", (0,)), ("quadratic_drag", (0,))}
    for is_right, beside in ((True, 2), (False, 1)):
        most.clear()
        search = find_causes(regression, tried, is_right=lambda _, right=is_right: right)
        assert {one.key for one in search.final.model.hypotheses} == true
        assert max(most) == beside


def test_no_event_is_needed_only_for_its_trials_to_be_learnt_from():
    """With a push a model is fitted to all trials; without it, by those that tell nothing of the stop."""
    trials = to_trials(stop_that_no_learning_trial_reaches(), cutoff_hz=25.0)
    regression = Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))
    stop = AtJoint(catalogue()["end_stop"], 0, {"side": 1.0})
    push = Pushes(catalogue()["external_push"], 0, np.array([[1.0, 0.3]]))
    both = fitted(regression, Model().plus(stop, np.array([0.8])).plus(push, np.zeros(0)))
    ascent = Ascent(regression, [stop], Starts(), fitted(regression, Model()), lambda _what, _done: None)
    accepted, causes = ascent._doubted(both, {stop.key})
    assert [one.key for one in accepted.model.hypotheses] == [stop.key]
    assert len(causes) == 1
    assert accepted.squares.sum() < 1.1 * both.squares.sum()
    assert ascent._come_to(accepted, causes, []).from_all
