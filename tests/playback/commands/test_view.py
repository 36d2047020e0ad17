"""What `limbplay view` takes, what it refuses, and what the page is asked to show."""

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import pytest

from playback.__main__ import main

Shown = Callable[..., argparse.Namespace]


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Shown:
    """Return what tells the arguments of a page, which is announced and not opened."""
    seen: list[argparse.Namespace] = []

    def run(arguments: argparse.Namespace, announce: Callable[[dict[str, object]], None]) -> None:
        seen.append(arguments)
        announce({"url": "http://127.0.0.1:1", "endpoint": "e", "control": None, "arm": "my arm"})

    monkeypatch.setattr("playback.view.session.run", run)

    def typed(*arguments: str) -> argparse.Namespace:
        assert main(["view", *arguments]) == 0
        return seen[-1]

    return typed


def test_by_default_the_playback_that_runs_is_shown(shown: Shown) -> None:
    page = shown()
    assert (page.connect, page.control) == ("tcp://127.0.0.1:5772", "tcp://127.0.0.1:5773")
    assert (page.host, page.port, page.open, page.touch, page.q0) == ("127.0.0.1", 8780, True, False, None)
    assert (page.arm, page.key) == (None, None)


@pytest.mark.parametrize(
    ("arguments", "connect", "control"),
    [
        (["--connect", "tcp://127.0.0.1:9"], "tcp://127.0.0.1:9", None),
        (["--connect", "tcp://127.0.0.1:9", "--control", "tcp://127.0.0.1:8"], "tcp://127.0.0.1:9", "tcp://127.0.0.1:8"),
        (["--control", "tcp://127.0.0.1:8"], "tcp://127.0.0.1:5772", "tcp://127.0.0.1:8"),
        (["motion.csv"], None, None),
        (["--reference", "ref.csv", "--arm", "dd-arm"], None, None),
        (["--live"], None, None),
        (["--touch"], None, None),
    ],
)  # fmt: skip
def test_what_is_shown_says_where_it_is_heard(
    shown: Shown, arguments: list[str], connect: str | None, control: str | None
) -> None:
    page = shown(*arguments)
    assert (page.connect, page.control) == (connect, control)


def test_a_motion_is_played_as_serve_would_and_again_and_again(shown: Shown) -> None:
    plain = shown("motion.csv").playback
    assert vars(plain) == {
        **dict.fromkeys(("reference", "live", "arm", "twin", "trial", "columns", "key", "keys")),
        **{"source": Path("motion.csv"), "rate_hz": 100.0, "play": False, "once": False},
    }
    options = ["--trial", "3", "--rate-hz", "50", "--play", "--twin", "dd-arm", "--columns", "t=time"]
    given = shown("motion.csv", *options).playback
    assert (given.trial, given.rate_hz, given.play) == (3, 50.0, True)
    assert (given.twin, given.columns) == ("dd-arm", "t=time")
    live = shown("--live", "--key", "me.limbkey", "--no-open")
    assert (live.playback.live, live.playback.key, live.open) == (
        "tcp://127.0.0.1:5770",
        Path("me.limbkey"),
        False,
    )


def test_an_arm_is_touched_where_it_rests(shown: Shown) -> None:
    assert shown("--touch").arm == "dd-arm"
    held = shown("--touch", "--arm", "human-arm-right", "--q0", "0.5,-1,2")
    assert (held.arm, held.q0) == ("human-arm-right", (0.5, -1.0, 2.0))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["motion.csv", "--live"], "source and --live are both given: expected one thing to show"),
        (["--live", "--touch"], "--live and --touch are both given"),
        (["--touch", "--control", "tcp://127.0.0.1:8"], "--touch and --connect are both given"),
        (["--reference", "ref.csv", "--connect", "tcp://127.0.0.1:9"], "source and --connect are both given"),
        (["--q0", "0.5,1"], "--q0 is given without --touch, which alone takes it"),
        (["--touch", "--q0", "half"], "found 'half', expected numbers such as 0.4,0.9"),
        (["--port", "-1"], "--port is -1, expected 0 to 65535"),
        (["--port", "65536"], "--port is 65536, expected 0 to 65535"),
    ],
)
def test_a_mistake_is_told_before_anything_starts(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["view", *arguments]) == 2
    output = capsys.readouterr()
    assert said in output.err and output.out == ""


def test_the_page_is_announced_for_people_and_programs(shown: Shown, capsys: pytest.CaptureFixture[str]) -> None:
    shown("--live")
    assert capsys.readouterr().out == "my arm: page at http://127.0.0.1:1\n"
    shown("--live", "--json")
    output = capsys.readouterr()
    assert json.loads(output.out)["arm"] == "my arm" and "page at" in output.err


def test_what_is_not_installed_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def missing(name: str) -> Callable[[str], None]:
        def load(_module: str) -> None:
            raise ModuleNotFoundError(name=name)

        return load

    monkeypatch.setattr("playback.commands.view.import_module", missing("viser"))
    assert main(["view"]) == 2
    assert "needs the package viser, which is not installed" in capsys.readouterr().err
    monkeypatch.setattr("playback.commands.view.import_module", missing("something else"))
    with pytest.raises(ModuleNotFoundError):
        main(["view"])


def test_markers_go_with_the_motion_tracked_from_them(shown: Shown, capsys: pytest.CaptureFixture[str]) -> None:
    assert shown("motion.csv", "--markers", "a.trc", "b.c3d").markers == [Path("a.trc"), Path("b.c3d")]
    assert main(["view", "--live", "--arm", "dd-arm", "--markers", "a.trc"]) == 2
    assert "--markers is given without SOURCE" in capsys.readouterr().err
