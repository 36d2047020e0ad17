"""Clocks of two motions, by when their trials begin and end."""

from dataclasses import replace

import pytest

from playback.common_clock import begins_after, spans_of
from playback.source import Source

LENGTHS_S = {1: 2.0, 2: 2.0}


def shifts(source: Source, own: dict[int, float], other: dict[int, float]):
    real = replace(source, durations_s=LENGTHS_S, begins_s=own)
    return begins_after(real, spans_of(other, LENGTHS_S), "twin.csv")


def test_equal_beginnings_need_no_word(source: Source) -> None:
    stamps = {1: 1.7e9, 2: 1.7e9 + 10.0}
    assert shifts(source, stamps, {trial: begin + 2.4e-7 for trial, begin in stamps.items()}) == (
        {1: 0.0, 2: 0.0},
        (),
    )
    assert shifts(source, {}, {}) == ({1: 0.0, 2: 0.0}, ())


def test_trials_that_overlap_are_on_one_clock(source: Source) -> None:
    later, (note,) = shifts(source, {1: 5.0, 2: 8.0}, {1: 5.5, 2: 7.5})
    assert later == {1: 0.5, 2: -0.5}
    assert "trial 1 begins 0.5 s later, trial 2 begins 0.5 s earlier" in note.text


@pytest.mark.parametrize("other", [{1: 5.5, 2: 10.0}, {1: 7.0, 2: 8.0}, {1: 0.0, 2: 0.0}])
def test_one_trial_apart_is_no_common_clock(source: Source, other: dict[int, float]) -> None:
    later, (note,) = shifts(source, {1: 5.0, 2: 8.0}, other)
    assert later == {1: 0.0, 2: 0.0} and "no common clock" in note.text


def test_a_clock_that_starts_anew_is_none_of_one_that_goes_on(source: Source) -> None:
    later, (note,) = shifts(source, {1: 0.0, 2: 2.5}, {1: 0.5, 2: 1.0})
    assert later == {1: 0.0, 2: 0.0} and "no common clock" in note.text
