"""Which cases are run, and the tables that are made of them."""

from argparse import Namespace
from typing import Any

from benchmarks.injected import Job, figures, jobs
from benchmarks.injection.effects import MORE, PAIRS


def options(**given: Any) -> Namespace:
    effects = [name for name, _ in (*PAIRS, *MORE)]
    usual = {"sets": ["double"], "sizes": [40, 20], "effects": effects, "more": False, "every": 1, "seed": 0}
    return Namespace(**(usual | given))


def test_nothing_injected_comes_first_and_every_pair_has_its_sizes() -> None:
    first, *rest = jobs(options())
    assert first == Job("double")
    assert len({job.key for job in rest}) == 2 * len(PAIRS)
    assert len(jobs(options(more=True))) == 1 + 2 * (len(PAIRS) + len(MORE))


def test_a_part_of_the_cases_has_both_joints_and_sizes() -> None:
    some = jobs(options(every=4))[1:]
    assert {(job.joint, job.percent) for job in some} == {(1, 40), (1, 20), (2, 40), (2, 20)}


def test_figures_count_right_names_and_wrong_ones() -> None:
    right = {"name": True, "size": True, "right": True, "wrong": []}
    wrong = {"name": False, "size": None, "right": False, "wrong": [["air_drag", [2]]]}
    lines = [
        vars(Job("double", "cogging", joint, 40)) | {"score": one, "seconds": 30.0}
        for joint, one in ((1, right), (2, wrong))
    ]
    assert "| 22 pairs | 40 % | 2 | 1 | 50 | 1 | 1 / 1 | 1 | 0 | 30 |" in figures(lines)
