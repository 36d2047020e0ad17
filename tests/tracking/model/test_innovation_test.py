"""When a filter is said to be wrong."""

import pytest

from tracking.model.innovation_test import Consistency, Judge


def judged(sizes, doubted=0, jolted=0):
    judge = Judge()
    for k, size in enumerate(sizes):
        judge.note(size, k < jolted, k < doubted)
    return judge.take()


def test_without_readings_there_is_no_judgement():
    assert Judge().take() == Consistency(None, 0, 0, False)


def test_a_filter_that_claims_what_it_does_is_right():
    said = judged([0.5, 1.5] * 500, jolted=7)
    assert said.size == pytest.approx(1.0)
    assert (said.jolts, said.doubted, said.wrong) == (7, 0, False)


def test_misses_larger_than_claimed_are_wrong():
    assert not judged([2.9] * 200).wrong
    assert judged([3.1] * 200).wrong


def test_doubts_beyond_one_in_a_hundred_are_wrong():
    assert not judged([1.0] * 1000, doubted=10).wrong
    assert judged([1.0] * 1000, doubted=11).wrong


def test_jolts_alone_are_no_fault():
    """An arm may jerk as often as it likes."""
    said = judged([1.0] * 1000, jolted=1000)
    assert said.jolts == 1000 and not said.wrong


def test_a_few_instants_are_no_evidence():
    assert not judged([1000.0] * 99, doubted=99).wrong
    assert judged([1000.0] * 100).wrong


def test_it_begins_anew_once_asked():
    judge = Judge()
    for _ in range(200):
        judge.note(50.0, True, True)
    assert judge.take().wrong
    assert judge.take() == Consistency(None, 0, 0, False)
    judge.note(0.5, False, False)
    assert judge.take() == Consistency(0.5, 0, 0, False)
