"""What is said of a cause whose numbers are told well, badly, or not at all."""

from dataclasses import replace

import numpy as np
import pytest

from arm.effects.catalogue import catalogue
from arm.model import Effect
from fitter.data.trials import to_trials
from fitter.diagnosis.at_joint import AtJoint
from fitter.diagnosis.causes import find_causes
from fitter.diagnosis.estimates import Estimates, estimates
from fitter.diagnosis.model import Model
from fitter.diagnosis.motion import run_of
from fitter.diagnosis.regression import Regression
from fitter.diagnosis.search import Search
from fitter.diagnosis.unknown import describe
from fitter.diagnosis.verdict import verdict_of
from tests.fitter.pendulum import pendulum, swings


@pytest.fixture(scope="module")
def regression() -> Regression:
    drag = Effect("quadratic_drag", {"drag_N_m_s2": 0.2}, joints=(1,))
    trials = to_trials(swings((drag,), trials=8, seed=2), cutoff_hz=25.0)
    return Regression(pendulum(), run_of(pendulum(), trials[:4], trials[4:]))


@pytest.fixture(scope="module")
def search(regression: Regression) -> Search:
    found = find_causes(regression, [AtJoint(catalogue()["quadratic_drag"], 0)])
    assert [one.kind.name for one in found.final.model.hypotheses] == ["quadratic_drag"]
    return found


def untold(found: Estimates) -> Estimates:
    """Return numbers whose errors are as large as they are."""
    effects = tuple(
        {name: replace(number, std=abs(number.value)) for name, number in one.items()} for one in found.effects
    )
    return replace(found, effects=effects)


@pytest.mark.parametrize(("share", "verdict"), [(0.05, "none"), (1.0, "named")])
def test_a_sole_cause_that_explains_much_is_named_though_no_number_of_it_is_told(
    regression: Regression, search: Search, share: float, verdict: str
) -> None:
    remainder = describe(regression, search.final)
    numbers = estimates(regression, search.final)
    worth = share * float(np.sum(search.told))
    # As much as it explains, and no more, was there to be explained.
    base = replace(search.base, squares=search.final.squares + worth / len(search.told))
    little = replace(search, base=base, causes=[replace(search.causes[0], worth=worth)])
    assert verdict_of(little, remainder, untold(numbers), held=False, strict=True) == verdict
    assert verdict_of(little, remainder, numbers, held=False, strict=True) == "named"


@pytest.mark.parametrize(
    ("share", "one_is_told", "verdict"),
    [(1.0, True, "unexplained"), (10.0, True, "named"), (10.0, False, "unexplained")],
)
def test_a_cause_without_a_size_must_explain_more_beside_one_that_has_a_size(
    regression: Regression, search: Search, share: float, one_is_told: bool, verdict: str
) -> None:
    remainder = describe(regression, search.final)
    numbers = estimates(regression, search.final)
    (cause,), (hypothesis,), (psi,) = search.causes, search.final.model.hypotheses, search.final.model.psi
    worth = share * float(np.sum(search.told))
    causes = [replace(cause, worth=worth), replace(cause, place=1, worth=worth)]
    final = replace(search.final, model=Model((hypothesis, hypothesis), (psi, psi)))
    two = replace(search, final=final, causes=causes)
    first = numbers.effects if one_is_told else untold(numbers).effects
    both = replace(numbers, effects=(*first, *untold(numbers).effects))
    assert verdict_of(two, remainder, both, held=False, strict=True) == verdict


def test_causes_that_a_function_outdoes_are_not_named(regression: Regression, search: Search) -> None:
    remainder = describe(regression, search.final)
    numbers = estimates(regression, search.final)
    outdone = replace(search, function=0.1)
    assert outdone.outdone and not search.outdone
    assert verdict_of(outdone, remainder, numbers, held=False, strict=True) == "unexplained"
    assert verdict_of(outdone, remainder, numbers, held=False, strict=False) == "named"
