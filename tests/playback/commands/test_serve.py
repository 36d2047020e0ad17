"""What `limbplay serve` takes where nothing is given, and what it refuses."""

import argparse
from pathlib import Path

import pytest

from playback.__main__ import main
from playback.commands import serve


def taken(*arguments: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    serve.add_arguments(parser)
    return parser.parse_args(arguments)


def test_by_default_it_waits_on_the_ports_of_the_page() -> None:
    plain = vars(taken("motion.csv"))
    del plain["action"]
    assert plain == {
        **dict.fromkeys(("columns", "arm", "reference", "twin", "live", "key", "trial", "keys")),
        **{"source": Path("motion.csv"), "rate_hz": 100.0, "play": False, "once": False},
        **{"endpoint": "tcp://127.0.0.1:5772", "control": "tcp://127.0.0.1:5773"},
    }


def test_a_live_stream_is_the_daemon_s_unless_said() -> None:
    assert taken("--live").live == "tcp://127.0.0.1:5770"
    assert taken("--live", "tcp://127.0.0.1:9").live == "tcp://127.0.0.1:9"


@pytest.mark.parametrize("rate", ["-1", "0", "1000.5", "inf", "nan"])
def test_a_rate_is_above_0_and_at_most_1000(rate: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "motion.csv", "--rate-hz", rate]) == 2
    assert f"--rate-hz is {float(rate):g}, expected above 0 and at most 1000" in capsys.readouterr().err


@pytest.mark.parametrize("rate", ["1e-3", "0.5", "1000"])
def test_any_other_rate_is_no_mistake(rate: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "nowhere.csv", "--rate-hz", rate]) == 2
    assert "nowhere.csv: there is no such file" in capsys.readouterr().err


def test_a_live_stream_has_no_end_to_leave_at(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--live", "tcp://127.0.0.1:9", "--arm", "nowhere.toml", "--once"]) == 2
    assert "--live and --once are both given" in capsys.readouterr().err


@pytest.mark.parametrize(
    "option",
    [["a.csv"], ["--reference", "a.csv"], ["--twin", "dd-arm"], ["--trial", "0"], ["--columns", "t=time"]],
)
def test_a_live_stream_takes_nothing_of_a_stored_one(
    option: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["serve", "--live", "tcp://127.0.0.1:9", *option]) == 2
    assert "are both given: a live stream is played as it comes" in capsys.readouterr().err
