"""Two ends of a line: what is said is heard in order, and an end that is gone is noticed."""

from multiprocessing import get_context

import pytest

from daemon.process.control_line import ControlLine, SupervisorGone


def both_ends() -> tuple[ControlLine, ControlLine]:
    ours, theirs = get_context("spawn").Pipe()
    return ControlLine(ours), ControlLine(theirs)


def test_what_is_said_is_heard_in_order() -> None:
    ours, theirs = both_ends()
    ours.tell("start")
    ours.tell("health", samples=5, latency_ms={"p50": None})
    assert theirs.hear(1.0) == {"what": "start"}
    assert theirs.hear(1.0) == {"what": "health", "samples": 5, "latency_ms": {"p50": None}}
    assert theirs.hear() is None
    ours.close()
    theirs.close()


def test_an_end_that_is_gone_is_noticed_after_its_last_words() -> None:
    ours, theirs = both_ends()
    ours.tell("failed")
    ours.close()
    assert theirs.hear() == {"what": "failed"}
    with pytest.raises(SupervisorGone):
        theirs.hear()
    theirs.tell("nobody listens")  # no error: the end is noticed by hearing
    theirs.close()
