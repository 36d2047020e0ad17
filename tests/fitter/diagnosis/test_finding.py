"""Causes as JSON has them."""

from fitter.diagnosis.finding import NamedCause, Tried
from fitter.search.fitted_parameter import FittedParameter


def test_a_cause_says_its_size_where_it_is_and_what_it_takes_away():
    size = {"mass_kg": FittedParameter(0.5, 0.01, "kg", True)}
    cause = NamedCause("payload", (2,), size, 0.75, {"since_s": 12.0}, {"learn": 0.4, "evaluate": 0.3}, True)
    assert cause.document() == {
        "effect": "payload",
        "joints": [2],
        "parameters": {
            "mass_kg": {"value": 0.5, "std": 0.01, "unit": "kg"},
            "since_s": {"value": 12.0, "std": None, "unit": "s"},
        },
        "support": 0.75,
        "takes_away": {"learn": 0.4, "evaluate": 0.3},
    }


def test_trials_have_no_unit_and_candidates_no_size():
    cause = NamedCause("payload", (), {}, 1.0, {"trials": [1, 3]})
    assert cause.document()["parameters"] == {"trials": {"value": [1, 3], "std": None, "unit": "1"}}
    assert Tried("cogging", (1,), 0.2, 0.1).document() == {
        "effect": "cogging",
        "joints": [1],
        "gain": 0.2,
        "support": 0.1,
    }
