"""What a page follows is started or found, and all of it is ended again."""

import argparse
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import psutil
import pytest

from limbcal.errors import ConfigError, DeviceError
from playback.commands.view import add_arguments
from playback.view import session


def arguments(*typed: object) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    given = parser.parse_args([*map(str, typed), "--port", "0", "--no-open"])
    names = ("source", "reference", "live", "arm", "twin", "trial", "columns", "rate_hz", "play", "key")
    given.playback = argparse.Namespace(**{name: getattr(given, name) for name in names}, keys=None, once=False)
    return given


class ShownError(Exception):
    """The page is there, and was looked at."""


Start = Callable[..., AbstractContextManager[Any]]


@pytest.fixture(autouse=True)
def nothing_left() -> Iterator[None]:
    """Fail a test that leaves a thread of a page."""
    yield
    assert not {thread.name for thread in threading.enumerate()} & {"feed", "remote", "hand"}


class Announced:
    """Takes what is announced of a page, and ends it at that."""

    def __init__(self) -> None:
        self.facts: dict[str, object] = {}

    def __call__(self, pages: dict[str, object]) -> None:
        self.facts = pages
        raise ShownError


@contextmanager
def showing() -> Iterator[Announced]:
    """Look at what is announced, and end the page."""
    with pytest.raises(ShownError):
        yield Announced()


def test_a_motion_is_played_beside_the_page(motion_file: Path) -> None:
    with showing() as announce:
        session.run(arguments(motion_file, "--arm", "dd-arm"), announce)
    facts = announce.facts
    assert facts["arm"] == "dd-arm" and str(facts["url"]).startswith("http://127.0.0.1:")
    assert str(facts["endpoint"]).startswith("ipc://") and str(facts["control"]).startswith("ipc://")
    assert not Path(str(facts["endpoint"]).removeprefix("ipc://")).parent.exists()


def test_a_playback_that_runs_is_asked_for_its_arm(start: Start, motion_file: Path) -> None:
    with start(motion_file, "--arm", "dd-arm-vertical") as running:
        running.ask("state")
        with showing() as announce:
            session.run(arguments("--connect", running.endpoint, "--control", running.control), announce)
        assert announce.facts["arm"] == "dd-arm-vertical"
        assert announce.facts["control"] == running.control
        assert running.process.poll() is None  # it goes on without the page


def test_an_arm_that_is_touched_has_no_control() -> None:
    with showing() as announce:
        session.run(arguments("--touch", "--arm", "dd-arm", "--q0", "0.1,0.2"), announce)
    assert announce.facts["control"] is None and announce.facts["arm"] == "dd-arm"


def test_a_stream_without_control_needs_an_arm(tmp_path: Path) -> None:
    endpoint = f"ipc://{tmp_path}/frames"
    with pytest.raises(ConfigError, match="--arm is missing: a stream without control does not say which arm"):
        session.run(arguments("--connect", endpoint), lambda _: pytest.fail("it is shown"))
    with showing() as announce:
        session.run(arguments("--connect", endpoint, "--arm", "dd-arm"), announce)


def test_nobody_at_the_control_endpoint_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "PATIENCE_S", 0.1)
    control = f"ipc://{tmp_path}/control"
    with pytest.raises(DeviceError, match=r"no answer within 0\.1 s, expected a `limbplay serve`"):
        session.run(arguments("--connect", f"ipc://{tmp_path}/x", "--control", control), lambda _: None)


def test_a_motion_that_cannot_be_played_is_a_mistake_of_who_asked(motion_file: Path) -> None:
    with pytest.raises(ConfigError, match="there is no trial 9, expected one of 1, 2, 3"):
        session.run(arguments(motion_file, "--arm", "dd-arm", "--trial", "9"), lambda _: None)


def test_a_playback_that_ends_ends_the_page(motion_file: Path) -> None:
    before = set(psutil.Process().children())

    def end(_facts: dict[str, object]) -> None:
        for child in set(psutil.Process().children()) - before:
            if "resource_tracker" not in " ".join(child.cmdline()):
                child.kill()

    with pytest.raises(DeviceError, match="the playback's process has ended"):
        session.run(arguments(motion_file, "--arm", "dd-arm"), end)


@pytest.mark.parametrize("wanted", [True, False])
def test_a_browser_is_opened_where_wanted(wanted: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    given = arguments("--connect", f"ipc://{tmp_path}/frames", "--arm", "dd-arm")
    given.open = wanted
    pages: list[dict[str, object]] = []

    def stop(_self: object, _over: object) -> None:
        raise ShownError

    monkeypatch.setattr(session.Page, "run", stop)
    with pytest.raises(ShownError):
        session.run(given, pages.append)
    assert opened == ([pages[0]["url"]] if wanted else [])


@pytest.mark.parametrize(("typed", "q0"), [((), None), (("--q0", "0.1,-0.2"), [0.1, -0.2])])
def test_an_arm_is_touched_where_it_was_put(
    typed: tuple[str, ...], q0: list[float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    put: list[Any] = []

    def touched(*given: Any) -> None:
        put.extend(given)
        raise ShownError

    monkeypatch.setattr(session, "TouchProcess", touched)
    with pytest.raises(ShownError):
        session.run(arguments("--touch", "--arm", "dd-arm-vertical", *typed), lambda _: None)
    arm, where = put
    assert arm.name == "dd-arm-vertical"
    assert (None if where is None else where.tolist()) == q0
