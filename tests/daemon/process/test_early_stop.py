"""A child that is still starting ends at a stop message, and when its supervisor is gone."""

import threading
from collections.abc import Iterator
from multiprocessing import get_context
from pathlib import Path

import pytest

from daemon.process.child_process import ChildProcess, wait_for_any
from daemon.process.control_line import ControlLine
from daemon.process.early_stop import stopped_early
from tests.patience import PATIENCE_S


@pytest.fixture
def child(tmp_path: Path) -> Iterator[ChildProcess]:
    """Start a child that is busy for good."""
    work = "tests.daemon.process.test_early_stop:be_busy"
    started = ChildProcess(get_context("spawn"), "test", work, str(tmp_path / "closed"))
    wait_for_any([started], [], PATIENCE_S)
    assert started.said() == [{"what": "busy"}]
    yield started
    started._process.kill()
    started._process.join(PATIENCE_S)
    started.close()


def be_busy(line: ControlLine, closed: str) -> None:
    """Be a child whose compiler does not come to an end."""
    with stopped_early(line, Path(closed).touch):
        line.tell("busy")
        threading.Event().wait()


def test_a_stop_ends_it(child: ChildProcess, tmp_path: Path) -> None:
    assert child.end(PATIENCE_S)
    assert (tmp_path / "closed").exists()
    assert child.said() is None


def test_behind_it_what_is_said_is_the_childs_own_to_hear(tmp_path: Path) -> None:
    ours, theirs = (ControlLine(end) for end in get_context("spawn").Pipe())
    with stopped_early(theirs, (tmp_path / "closed").touch):
        pass
    ours.tell("stop")
    assert theirs.hear(PATIENCE_S) == {"what": "stop"}
    assert not (tmp_path / "closed").exists()
    assert "early-stop" not in {thread.name for thread in threading.enumerate()}
    ours.close()
    theirs.close()


def test_it_does_not_outlive_its_supervisor(child: ChildProcess, tmp_path: Path) -> None:
    child.line.close()
    child._process.join(PATIENCE_S)
    assert not child.alive and (tmp_path / "closed").exists()
