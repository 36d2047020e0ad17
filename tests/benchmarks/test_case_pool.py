"""A case always gives a line, whatever comes of it."""

import time
from dataclasses import dataclass
from typing import Any

from benchmarks.case_pool import Guarded, timed


@dataclass(frozen=True)
class Job:
    key: str = "one/cogging/3"


def test_a_case_that_fails_or_takes_too_long_has_an_error() -> None:
    def fail(_job: Job) -> dict[str, Any]:
        raise ValueError("no arm")

    assert Guarded(lambda _job: {"said": "none"}, 60.0)(Job()) == {"key": "one/cogging/3", "said": "none"}
    assert "no arm" in Guarded(fail, 60.0)(Job())["error"]
    assert "not done after 0.001 s" in Guarded(lambda _job: time.sleep(60.0) or {}, 0.001)(Job())["error"]


def test_what_was_made_comes_with_its_times() -> None:
    made, took = timed(lambda: 3)
    assert made == 3
    assert set(took) == {"seconds", "processor_s"}
