"""Equals of a cause are those that are as likely beside all the other causes."""

from dataclasses import replace

import numpy as np
import pytest

from fitter.diagnosis.equal_causes import with_equals
from fitter.diagnosis.evidence import penalised_log_likelihood
from fitter.diagnosis.search import cause_of
from fitter.diagnosis.stepwise import Found, Step
from tests.fitter.diagnosis.linear import Columns, LinearLikelihood

N = 2000
CAUSE, RIVAL, LATER = Columns(0), Columns(1), Columns(2)


def found(apart: float) -> tuple[LinearLikelihood, Found]:
    """Return two causes, the first of which had an equal that differs from it by a part of its size."""
    rng = np.random.default_rng(3)
    A = rng.normal(size=(N, 3))
    A[:, 1] = A[:, 0] + apart * A[:, 1]
    likelihood = LinearLikelihood(A, A[:, 0] + 40.0 * A[:, 2] + rng.normal(size=N), (CAUSE, RIVAL, LATER))
    alone, rival, both = likelihood.fit_of(CAUSE), likelihood.fit_of(RIVAL), likelihood.fit_of(CAUSE, LATER)
    steps = (
        Step(CAUSE, alone, likelihood.base(), 50.0, (rival,), (alone, rival)),
        Step(LATER, both, alone, 50.0),
    )
    return likelihood, Found(likelihood.base(), both, steps, ())


def test_an_equal_has_its_numbers_beside_the_other_causes():
    likelihood, before = found(1e-3)
    after = with_equals(likelihood, before)
    (equal,), (alone,) = after.steps[0].beside, after.steps[0].equals
    assert equal.candidate.model.hypotheses == (LATER, RIVAL) and alone.candidate.model.hypotheses == (RIVAL,)
    assert equal.candidate.x == pytest.approx([40.0, 1.0], abs=0.1)
    cause = cause_of(0, after)
    assert [one.hypothesis for one in cause.rivals] == [one.hypothesis for one in cause.beside] == [RIVAL]
    assert cause.support == pytest.approx([0.5, 0.5], abs=0.1)
    assert cause.beaten == []


def test_what_was_as_likely_while_much_was_unexplained_may_be_so_no_more():
    likelihood, before = found(0.5)
    after = with_equals(likelihood, before)
    assert after.steps[0].equals == after.steps[0].beside == ()
    assert after.final is before.final and after.steps[1] == before.steps[1]


def test_of_equals_the_likeliest_beside_the_others_is_named():
    likelihood, before = found(1e-3)
    other = likelihood.fit_of(RIVAL, LATER)
    wrong = [before, replace(before, final=other, steps=(exchanged(before.steps[0]), before.steps[1]))]
    likeliest = max((before.final, other), key=penalised_log_likelihood).candidate.model.hypotheses[0]
    for one in wrong:
        after = with_equals(likelihood, one)
        hypotheses = after.final.candidate.model.hypotheses
        assert hypotheses == tuple(step.hypothesis for step in after.steps)
        assert set(hypotheses) == {likeliest, LATER}
        cause = cause_of(hypotheses.index(likeliest), after)
        assert cause.itself.hypothesis is likeliest
        assert [one.hypothesis for one in cause.rivals] == [RIVAL if likeliest is CAUSE else CAUSE]
        assert cause.support[0] >= cause.support[1]


def exchanged(step: Step) -> Step:
    """Return a step with its equal as its cause."""
    (equal,) = step.equals
    return replace(step, hypothesis=equal.candidate.hypothesis, fit=equal, equals=(step.fit,))
