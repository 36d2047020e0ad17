"""Errors on trials that had no say, by set and by trial."""

import numpy as np
import pytest

from fitter.diagnosis.judged_sets import Judged
from fitter.diagnosis.judgement import Errors


def errors(*rms: float) -> Errors:
    one = np.array(rms) ** 2
    count, still = np.ones_like(one), np.zeros_like(one)
    return Errors(one[:, None], count[:, None], None, still, still, still, count, [np.zeros((1, 1))] * len(rms))


def test_sets_and_trials_have_errors_of_their_own():
    found = Judged(("monday", "monday", "tuesday"), ("a", "b", "a"), errors(1.0, 2.0, 3.0), errors(0.1, 0.2, 0.3))
    document = found.document()
    assert document["after"]["torque_rms_N_m"] == pytest.approx([np.sqrt(0.14 / 3.0)])
    assert set(document["before"]["sets"]) == {"monday", "tuesday"}
    assert document["before"]["sets"]["monday"]["torque_rms_N_m"] == pytest.approx([np.sqrt(2.5)])
    trials = {name: one["torque_rms_N_m"][0] for name, one in document["after"]["trials"].items()}
    assert trials == pytest.approx({"monday/a": 0.1, "b": 0.2, "tuesday/a": 0.3})


def test_trials_of_one_set_and_name_are_counted():
    found = Judged(("day", "day"), ("a", "a"), errors(1.0, 2.0), errors(1.0, 2.0))
    assert list(found.by_trial()) == ["day/a", "day/a (2)"]
