"""How many items are done at once."""

import contextvars
import os

import pytest

from fitter.parallel.processors import processors, work_alone


@pytest.mark.parametrize(("there", "items", "expected"), [(3, 5, 3), (3, 2, 2), (3, 0, 1), (64, 64, 8)])
def test_no_more_than_processors_items_and_a_limit(monkeypatch, there, items, expected):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _process: set(range(there)))
    assert processors(items) == expected


def test_who_works_alone_has_one(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _process: {0, 1, 2})
    alone = contextvars.copy_context()
    alone.run(work_alone)
    assert alone.run(processors, 3) == 1
    assert processors(3) == 3
