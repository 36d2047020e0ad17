"""Which cases are run."""

from benchmarks.diagnosis import jobs
from benchmarks.hidden_arms.effects import EFFECTS


def test_effects_take_turns_and_seeds_of_two_kinds_never_meet() -> None:
    one, two = jobs("one", len(EFFECTS), 500, None), jobs("two", 3, 500, None)
    assert {job.effect for job in one} == set(EFFECTS)
    assert not {job.seed for job in one} & {job.seed for job in two}


def test_a_part_is_the_same_cases() -> None:
    assert jobs("one", 3, 500, None) == jobs("one", 5, 500, None)[:3]
    assert {job.effect for job in jobs("one", 4, 0, "payload")} == {"payload"}
