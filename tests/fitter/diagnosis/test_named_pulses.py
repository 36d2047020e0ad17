"""Pushes are reported one by one, on the clock of the file that they are in."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fitter.diagnosis.conclusion import pushes_of
from fitter.diagnosis.finding import NamedCause
from fitter.search.fitted_parameter import FittedParameter

LASTS_S, TRIMMED_S = 5.0, 0.1


def motions(began):
    """Return trials that follow each other on the run's clock, and begin on the file's as given."""
    t = np.arange(TRIMMED_S, LASTS_S - TRIMMED_S, 0.01)
    return [
        SimpleNamespace(t=k * LASTS_S + t, trial=SimpleNamespace(name=f"trial {k}"), ahead_s=k * LASTS_S - began_s)
        for k, began_s in enumerate(began)
    ]


def cause(pushes):
    """Return several pushes as one cause; (start, duration, torque) each."""
    names, parameters = ("start_s", "duration_s", "torque_N_m"), {}
    for k, push in enumerate(pushes, 1):
        end = f"_{k}" if len(pushes) > 1 else ""
        parameters |= {
            name + end: FittedParameter(value, 0.01, "s", True) for name, value in zip(names, push, strict=True)
        }
    return NamedCause("external_push", (1,), parameters, 0.7, {}, {"learn": 0.5})


@given(
    st.lists(st.floats(0.0, 1e4), min_size=1, max_size=6),
    st.lists(st.tuples(st.integers(0, 5), st.floats(0.2, 4.7)), min_size=1, max_size=4),
)
def test_each_is_told_in_its_trial_on_the_files_clock(began, places):
    run = motions(began)
    places = [(k % len(began), at_s) for k, at_s in places]
    pushes = [(k * LASTS_S + at_s, 0.3, float(i)) for i, (k, at_s) in enumerate(places)]
    listed = pushes_of(run, cause(pushes))
    assert len(listed) == len(pushes)
    for i, ((k, at_s), one) in enumerate(zip(places, listed, strict=True)):
        assert one.where == {"trial": f"trial {k}"}
        assert list(one.parameters) == ["start_s", "duration_s", "torque_N_m"]
        values = [number.value for number in one.parameters.values()]
        assert values == pytest.approx([began[k] + at_s, 0.3, float(i)])
        assert (one.effect, one.joints, one.support, one.takes_away) == (
            "external_push",
            (1,),
            0.7,
            {"learn": 0.5},
        )
        assert one.parameters["start_s"].std == 0.01


def test_one_between_trials_is_told_in_the_nearest():
    (before,) = pushes_of(motions([0.0, 100.0]), cause([(4.95, 0.3, 1.0)]))
    (after,) = pushes_of(motions([0.0, 100.0]), cause([(5.05, 0.3, 1.0)]))
    assert [one.where["trial"] for one in (before, after)] == ["trial 0", "trial 1"]
    assert after.parameters["start_s"].value == pytest.approx(100.05)


def test_its_document_says_in_which_trial():
    (one,) = pushes_of(motions([2.0]), cause([(1.0, 0.3, 1.0)]))
    document = one.document()
    assert document["parameters"]["trial"]["value"] == "trial 0"
    assert document["parameters"]["start_s"]["value"] == pytest.approx(3.0)
