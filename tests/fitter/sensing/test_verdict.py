"""What trackers say of themselves."""

import pytest

from fitter.sensing.verdict import Verdict, overall, verdict_of
from tracking.model.innovation_test import Consistency


def test_instants_become_a_share_of_the_frames():
    verdict = verdict_of(Consistency(0.7, 12, 30, True), 1000)
    assert (verdict.innovation, verdict.doubted, verdict.wrong) == (0.7, 0.03, True)
    assert verdict.passes is None and verdict.converged is None


def test_a_tracker_that_claims_nothing():
    assert verdict_of(Consistency(None, 0, 0, False), 1000) == Verdict()
    assert overall([Verdict(), Verdict()], [10, 20]) == {}


def test_runs_count_by_their_frames():
    filtered = [
        Verdict(innovation=1.0, doubted=0.0, wrong=False),
        Verdict(innovation=4.0, doubted=0.3, wrong=True),
    ]
    assert overall(filtered, [200, 100]) == pytest.approx({"innovation": 2.0, "doubted": 0.1, "wrong": True})
    smoothed = [Verdict(doubted=0.0, wrong=False, passes=k, converged=k < 5) for k in (3, 5, 4)]
    assert overall(smoothed, [10, 10, 10]) == {"doubted": 0.0, "wrong": False, "passes": 5, "converged": False}


def test_a_run_without_readings_does_not_count():
    assert overall([Verdict(), Verdict(innovation=2.0)], [0, 10]) == {"innovation": 2.0}


def test_what_a_model_lacks_most_of_any_run_is_said():
    runs = [
        Verdict(wrong=True, discrepancy_m_s2=0.3, base_m_s2=0.0, discrepancy_rad_s=0.02),
        Verdict(wrong=True, discrepancy_m_s2=0.1, base_m_s2=0.5),
    ]
    expected = {"wrong": True, "discrepancy_m_s2": 0.3, "base_m_s2": 0.5, "discrepancy_rad_s": 0.02}
    assert overall(runs, [10, 10]) == expected
